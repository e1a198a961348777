// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_FROSTED_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_FROSTED_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_FROSTED_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_FROSTED_LANES_INL_H_
#endif

#include "core/materials/bsdf_lanes-inl.h"

// The rough Bsdf of dielectric.cpp: see bsdf_lanes-inl.h.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// DielectricBsdf, rough.
struct FrostedLobe {
    Vec3Lanes wo, tint;
    Floats ior;
    GgxLanes ggx;

    template <typename Path>
    HWY_INLINE FrostedLobe(const Path& path, const Vec3Lanes& towards) : wo(towards), ggx{path.numbers(1).x} {
        const FourLanes all = path.numbers(0);
        tint = all.xyz();
        ior = all.w;
    }

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wi) const {
        const FloatMask reflects = positive(wo.z * wi.z);
        const Vec3Lanes o = upper(wo), i = upper(wi);
        const Facets facets(*this, o, i, reflects);
        const Floats pdf = facets.pdf(ggx.reflection_pdf(o, facets.normal()), reflects);
        return {tint * (ggx.g1(i) * pdf), pdf};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
        const Floats eta = hn::IfThenElse(positive(wo.z), ior, one / ior);
        const Vec3Lanes o = upper(wo), m = ggx.sample_visible(o, numbers.direction());
        const Floats fresnel = fresnel_dielectric(hn::Min(hn::Max(dot(o, m), zero), one), eta);
        const FloatMask reflects = hn::Lt(numbers.lobe(), fresnel);
        Vec3Lanes wi = select(reflects, reflect(o, m), refract(o, m, eta));
        const FloatMask there = hn::AndNot(hn::Xor(reflects, positive(wi.z)), finite(wi));
        wi.z = negated_where(below_zero(wo.z), wi.z);
        const BsdfValueLanes f = evaluate(wi);
        return {wi, f.value / f.pdf, f.pdf, there};
    }

private:
    /// The facets that scatter from one direction into another, and what they do.
    struct Facets {
        alignas(64) float m[3][kLanes];
        alignas(64) double share[kLanes];  ///< Of the light that they send there; 0 where they are seen from behind.
        alignas(64) double cosine[kLanes], jacobian[kLanes];

        HWY_INLINE Facets(const FrostedLobe& glass, const Vec3Lanes& o, const Vec3Lanes& i, FloatMask reflects) {
            const FloatTag d;
            const DoubleTag dd;
            const hn::Rebind<float, DoubleTag> df;
            const Floats one = all_lanes(1.0f);
            const Floats given[] = {o.x,
                                    o.y,
                                    o.z,
                                    i.x,
                                    i.y,
                                    hn::IfThenElse(reflects, i.z, hn::Neg(i.z)),
                                    glass.ior,
                                    hn::IfThenElseZero(positive(glass.wo.z), one),
                                    hn::IfThenElseZero(reflects, one)};
            alignas(64) float rows[std::size(given)][kLanes];
            for (std::size_t k = 0; k < std::size(given); ++k) hn::Store(given[k], d, rows[k]);
            for (std::size_t lane = 0; lane < kLanes; lane += kDoubles) {
                const auto load = [&](int row) HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, rows[row] + lane)); };
                const Doubles relative_ior = load(6), zero = hn::Zero(dd), unit = all_doubles(1);
                const auto outside = hn::Gt(load(7), zero), mirrored = hn::Gt(load(8), zero);
                const Doubles eta = hn::IfThenElse(outside, relative_ior, hn::Div(unit, relative_ior));
                const DoubleAxes od = normalize({load(0), load(1), load(2)});
                const DoubleAxes id = normalize({load(3), load(4), load(5)});
                const DoubleAxes half = od + hn::IfThenElse(mirrored, unit, eta) * id;
                const auto below = hn::Lt(half.z, zero);
                const auto turned = [&](Doubles x) HWY_ATTR { return hn::IfThenElse(below, hn::Neg(x), x); };
                const DoubleAxes md = normalize({turned(half.x), turned(half.y), turned(half.z)});
                const Doubles o_m = dot(od, md), i_m = dot(id, md);
                const auto seen = hn::AndNot(hn::Xor(mirrored, hn::Gt(i_m, zero)), hn::Gt(o_m, zero));
                const Doubles fresnel = fresnel_dielectric(hn::Min(o_m, unit), eta);
                const Doubles scale = hn::Add(i_m, hn::Div(o_m, eta));
                hn::Store(hn::DemoteTo(df, md.x), df, m[0] + lane);
                hn::Store(hn::DemoteTo(df, md.y), df, m[1] + lane);
                hn::Store(hn::DemoteTo(df, md.z), df, m[2] + lane);
                hn::Store(hn::IfThenElseZero(seen, hn::IfThenElse(mirrored, fresnel, hn::Sub(unit, fresnel))), dd,
                          share + lane);
                hn::Store(o_m, dd, cosine + lane);
                hn::Store(hn::Div(hn::Neg(i_m), hn::Mul(scale, scale)), dd, jacobian + lane);
            }
        }

        HWY_INLINE Vec3Lanes normal() const {
            const FloatTag d;
            return {hn::Load(d, m[0]), hn::Load(d, m[1]), hn::Load(d, m[2])};
        }
        /// Density of the direction from that of its mirror image.
        HWY_INLINE Floats pdf(Floats reflection_pdf, FloatMask reflects) const {
            const FloatTag d;
            const DoubleTag dd;
            const hn::Rebind<float, DoubleTag> df;
            alignas(64) float mirror[kLanes], reflected[kLanes], refracted[kLanes];
            hn::Store(reflection_pdf, d, mirror);
            for (std::size_t lane = 0; lane < kLanes; lane += kDoubles) {
                const Doubles p = hn::Mul(hn::Load(dd, share + lane), hn::PromoteTo(dd, hn::Load(df, mirror + lane)));
                const Doubles bent = hn::Mul(hn::Mul(hn::Mul(p, all_doubles(4)), hn::Load(dd, cosine + lane)),
                                             hn::Load(dd, jacobian + lane));
                hn::Store(hn::DemoteTo(df, p), df, reflected + lane);
                hn::Store(hn::DemoteTo(df, bent), df, refracted + lane);
            }
            return hn::IfThenElse(reflects, hn::Load(d, reflected), hn::Load(d, refracted));
        }
    };
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
