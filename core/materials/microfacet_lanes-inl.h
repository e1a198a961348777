// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_MICROFACET_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_MICROFACET_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_MICROFACET_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_MICROFACET_LANES_INL_H_
#endif

#include "core/math/double_lanes-inl.h"
#include "core/math/vec_lanes-inl.h"

// microfacet.h and fresnel.h, one surface a lane: the same operations in the same order, and so the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE FloatMask positive(Floats x) {
    return hn::Gt(x, hn::Zero(FloatTag()));
}
HWY_INLINE FloatMask below_zero(Floats x) {
    return hn::Lt(x, hn::Zero(FloatTag()));
}
HWY_INLINE FloatMask finite(Floats x) {
    return hn::Lt(hn::Abs(x), all_lanes(kInfinity));
}
HWY_INLINE FloatMask finite(const Vec3Lanes& v) {
    return hn::And(finite(v.x), hn::And(finite(v.y), finite(v.z)));
}
HWY_INLINE Floats clamp_unit(Floats x) {
    return hn::Min(hn::Max(x, hn::Zero(FloatTag())), all_lanes(1.0f));
}
/// glm::mix.
HWY_INLINE Floats mix(Floats a, Floats b, Floats share) {
    return a * (all_lanes(1.0f) - share) + b * share;
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

/// As dielectric.cpp has it.
HWY_INLINE Vec3Lanes refract(const Vec3Lanes& w, const Vec3Lanes& m, Floats eta) {
    const Floats one = all_lanes(1.0f), cos_i = dot(w, m);
    const Floats squared = (eta - one) * (eta + one) + cos_i * cos_i;
    const Floats cos_t = hn::Sqrt(hn::Max(squared, hn::Zero(FloatTag()))) / eta;
    return normalize(m * (cos_i / eta - cos_t) - w / eta);
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

HWY_INLINE Floats schlick_weight(Floats cos_i) {
    const Floats m = all_lanes(1.0f) - cos_i;
    return (m * m) * (m * m) * m;
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
    HWY_INLINE Floats g2_over_g1(const Vec3Lanes& wo, const Vec3Lanes& wi) const {
        const Floats root_o = root(wo);
        return wi.z * (wo.z + root_o) / (wo.z * root(wi) + wi.z * root_o);
    }
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

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
