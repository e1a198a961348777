// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_SINGLE_LOBE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_SINGLE_LOBE_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_SINGLE_LOBE_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_SINGLE_LOBE_LANES_INL_H_
#endif

#include "core/math/double_lanes-inl.h"
#include "core/math/vec_lanes-inl.h"

// The Bsdfs that are a SingleLobe, one a lane: the operations of microfacet.h, fresnel.h, metal.cpp and dielectric.cpp in
// their order, and so the same bits. Each lobe has
//     evaluate(wo, wi)         where wo and wi are on the same side; not for deltas
//     sample(wo, numbers)      drawing numbers.lobe() and numbers.direction() where it needs them

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

struct BsdfValueLanes {
    Vec3Lanes value;
    Floats pdf;
};

struct BsdfSampleLanes {
    Vec3Lanes wi, weight;
    Floats pdf;
    FloatMask there;
};

HWY_INLINE FloatMask positive(Floats x) {
    return hn::Gt(x, hn::Zero(FloatTag()));
}
HWY_INLINE FloatMask below_zero(Floats x) {
    return hn::Lt(x, hn::Zero(FloatTag()));
}
HWY_INLINE FloatMask finite(Floats x) {
    return hn::Lt(hn::Abs(x), all_lanes(kInfinity));
}
/// Where `mask`, with the other sign.
HWY_INLINE Floats negated_where(FloatMask mask, Floats x) {
    return hn::IfThenElse(mask, hn::Neg(x), x);
}
HWY_INLINE Vec3Lanes upper(const Vec3Lanes& w) {
    return {w.x, w.y, negated_where(below_zero(w.z), w.z)};
}
HWY_INLINE Vec3Lanes reflect(const Vec3Lanes& w, const Vec3Lanes& m) {
    return m * (all_lanes(2.0f) * dot(w, m)) - w;
}

HWY_INLINE DoubleAxes renormalize(const DoubleAxes& w) {
    return hn::Sub(all_doubles(1.5), hn::Mul(all_doubles(0.5), dot(w, w))) * w;
}

HWY_INLINE Vec3Lanes half_vector(const Vec3Lanes& wo, const Vec3Lanes& wi) {
    const FloatTag d;
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    alignas(64) float rows[6][kLanes], sums[3][kLanes];
    const Floats given[] = {wo.x, wo.y, wo.z, wi.x, wi.y, wi.z};
    for (int k = 0; k < 6; ++k) hn::Store(given[k], d, rows[k]);
    for (std::size_t i = 0; i < kLanes; i += kDoubles) {
        const auto load = [&](int row) HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, rows[row] + i)); };
        const DoubleAxes sum = renormalize({load(0), load(1), load(2)}) + renormalize({load(3), load(4), load(5)});
        hn::Store(hn::DemoteTo(df, sum.x), df, sums[0] + i);
        hn::Store(hn::DemoteTo(df, sum.y), df, sums[1] + i);
        hn::Store(hn::DemoteTo(df, sum.z), df, sums[2] + i);
    }
    return normalize(Vec3Lanes{hn::Load(d, sums[0]), hn::Load(d, sums[1]), hn::Load(d, sums[2])});
}

HWY_INLINE Doubles fresnel_dielectric(Doubles cos_i, Doubles eta) {
    const Doubles one = all_doubles(1), zero = all_doubles(0);
    const Doubles eta2 = eta * eta, k = (eta - one) * (eta + one);
    const Doubles sin2_i = (one - cos_i) * (one + cos_i), g2 = eta2 - sin2_i, g = hn::Sqrt(g2);
    const Doubles s = cos_i + g, p = eta2 * cos_i + g;
    const Doubles r_s = k / (s * s), r_p = k * (eta2 * cos_i * cos_i - sin2_i) / (p * p);
    const Doubles partial = hn::Min(all_doubles(0.5) * (r_s * r_s + r_p * r_p), one);
    return hn::IfThenElse(hn::Gt(g2, zero), partial, hn::IfThenElse(hn::Eq(k, zero), zero, one));
}

HWY_INLINE Floats fresnel_dielectric(Floats cos_i, Floats eta) {
    const FloatTag d;
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    alignas(64) float cosines[kLanes], etas[kLanes], reflected[kLanes];
    hn::Store(cos_i, d, cosines);
    hn::Store(eta, d, etas);
    for (std::size_t i = 0; i < kLanes; i += kDoubles) {
        const auto load = [&](const float* row) HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, row + i)); };
        hn::Store(hn::DemoteTo(df, fresnel_dielectric(load(cosines), load(etas))), df, reflected + i);
    }
    return hn::Load(d, reflected);
}

/// Ggx, one a lane.
struct GgxLanes {
    Floats alpha;

    HWY_INLINE Floats d(const Vec3Lanes& m) const {
        const Floats a2 = alpha * alpha;
        const Floats k = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
        return a2 / (all_lanes(kPi) * k * k);
    }
    HWY_INLINE Floats root(const Vec3Lanes& w) const {
        return hn::Sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y));
    }
    HWY_INLINE Floats g1(const Vec3Lanes& w) const { return all_lanes(2.0f) * w.z / (w.z + root(w)); }
    HWY_INLINE Floats reflection_pdf(const Vec3Lanes& wo, const Vec3Lanes& m) const {
        return d(m) / (all_lanes(2.0f) * (wo.z + root(wo)));
    }
    HWY_INLINE Vec3Lanes sample_visible(const Vec3Lanes& wo, const Vec2Lanes& u) const {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
        const Vec3Lanes stretched = normalize(Vec3Lanes{alpha * wo.x, alpha * wo.y, wo.z});
        const Floats z = (one - u.y) * (one + stretched.z) - stretched.z;
        const Floats sine = hn::Sqrt(hn::Max(one - z * z, zero));
        const Vec2Lanes around = cos_sin_turns(u.x);
        const Vec3Lanes h = Vec3Lanes{sine * around.x, sine * around.y, z} + stretched;
        return normalize(Vec3Lanes{alpha * h.x, alpha * h.y, hn::Max(h.z, zero)});
    }
};

/// DiffuseBsdf.
struct MatteLobe {
    Vec3Lanes albedo;

    HWY_INLINE MatteLobe(const Vec3Lanes& color, Floats) : albedo(color) {}

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes&, const Vec3Lanes& wi) const {
        const Floats pdf = all_lanes(kInvPi) * hn::Abs(wi.z);
        return {albedo * pdf, pdf};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Vec3Lanes& wo, const Numbers& numbers) const {
        Vec3Lanes wi = sample_cosine_hemisphere(numbers.direction());
        wi.z = negated_where(below_zero(wo.z), wi.z);
        return {wi, albedo, all_lanes(kInvPi) * hn::Abs(wi.z), hn::Not(is_black(albedo))};
    }
};

/// MetalBsdf, rough, one bounce.
struct FacetLobe {
    Vec3Lanes reflectance;
    GgxLanes ggx;

    HWY_INLINE FacetLobe(const Vec3Lanes& color, Floats alpha) : reflectance(color), ggx{alpha} {}

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wo, const Vec3Lanes& wi) const {
        const Vec3Lanes o = upper(wo), i = upper(wi);
        const Floats pdf = ggx.reflection_pdf(o, half_vector(o, i));
        return {reflectance * (ggx.g1(i) * pdf), pdf};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Vec3Lanes& wo, const Numbers& numbers) const {
        const Vec3Lanes o = upper(wo);
        Vec3Lanes wi = reflect(o, ggx.sample_visible(o, numbers.direction()));
        const FloatMask finite_wi = hn::And(finite(wi.x), hn::And(finite(wi.y), finite(wi.z)));
        const FloatMask there = hn::AndNot(is_black(reflectance), hn::And(positive(wi.z), finite_wi));
        wi.z = negated_where(below_zero(wo.z), wi.z);
        const BsdfValueLanes f = evaluate(wo, wi);
        return {wi, f.value / f.pdf, f.pdf, there};
    }
};

/// MetalBsdf, smooth.
struct MirrorLobe {
    Vec3Lanes reflectance;

    HWY_INLINE MirrorLobe(const Vec3Lanes& color, Floats) : reflectance(color) {}

    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Vec3Lanes& wo, const Numbers&) const {
        return {{hn::Neg(wo.x), hn::Neg(wo.y), wo.z}, reflectance, all_lanes(1.0f), hn::Not(is_black(reflectance))};
    }
};

/// DielectricBsdf, smooth.
struct GlassLobe {
    Vec3Lanes tint;
    Floats ior;

    HWY_INLINE GlassLobe(const Vec3Lanes& color, Floats index) : tint(color), ior(index) {}

    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Vec3Lanes& wo, const Numbers& numbers) const {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
        const Floats eta = hn::IfThenElse(positive(wo.z), ior, one / ior);
        const Vec3Lanes o = upper(wo), m = all_lanes(Vec3(0, 0, 1));
        const Floats fresnel = fresnel_dielectric(hn::Min(hn::Max(dot(o, m), zero), one), eta);
        const FloatMask reflects = hn::Lt(numbers.lobe(), fresnel);
        Vec3Lanes wi = select(reflects, reflect(o, m), refract(o, m, eta));
        const FloatMask there = hn::Not(hn::Xor(reflects, positive(wi.z)));
        wi.z = negated_where(below_zero(wo.z), wi.z);
        return {wi, tint, hn::IfThenElse(reflects, fresnel, one - fresnel), there};
    }

private:
    static HWY_INLINE Vec3Lanes refract(const Vec3Lanes& w, const Vec3Lanes& m, Floats eta) {
        const Floats one = all_lanes(1.0f), cos_i = dot(w, m);
        const Floats squared = (eta - one) * (eta + one) + cos_i * cos_i;
        const Floats cos_t = hn::Sqrt(hn::Max(squared, hn::Zero(FloatTag()))) / eta;
        return normalize(m * (cos_i / eta - cos_t) - w / eta);
    }
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
