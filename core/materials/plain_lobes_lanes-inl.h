// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_PLAIN_LOBES_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_PLAIN_LOBES_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_PLAIN_LOBES_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_PLAIN_LOBES_LANES_INL_H_
#endif

#include "core/materials/bsdf_lanes-inl.h"
#include "core/materials/ggx_albedo_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"

// The Bsdfs of diffuse.cpp and metal.cpp and the smooth one of dielectric.cpp: see bsdf_lanes-inl.h.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// DiffuseBsdf.
struct MatteLobe {
    Vec3Lanes wo, albedo;

    template <typename Path>
    HWY_INLINE MatteLobe(const Path& path, const Vec3Lanes& towards) : wo(towards), albedo(path.numbers(0).xyz()) {}

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wi) const {
        const Floats pdf = all_lanes(kInvPi) * hn::Abs(wi.z);
        return {albedo * pdf, pdf};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
        Vec3Lanes wi = sample_cosine_hemisphere(numbers.direction());
        wi.z = negated_where(below_zero(wo.z), wi.z);
        return {wi, albedo, all_lanes(kInvPi) * hn::Abs(wi.z), hn::Not(is_black(albedo))};
    }
};

/// MetalBsdf, rough, one bounce.
struct FacetLobe {
    Vec3Lanes wo, reflectance;
    GgxLanes ggx;

    template <typename Path>
    HWY_INLINE FacetLobe(const Path& path, const Vec3Lanes& towards) : wo(towards) {
        const FourLanes all = path.numbers(0);
        reflectance = all.xyz();
        ggx = {all.w};
    }

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wi) const {
        const Vec3Lanes o = upper(wo), i = upper(wi);
        const Floats pdf = ggx.reflection_pdf(o, half_vector(o, i));
        return {reflectance * (ggx.g1(i) * pdf), pdf};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
        const Vec3Lanes o = upper(wo);
        Vec3Lanes wi = reflect(o, ggx.sample_visible(o, numbers.direction()));
        const FloatMask there = hn::AndNot(is_black(reflectance), hn::And(positive(wi.z), finite(wi)));
        wi.z = negated_where(below_zero(wo.z), wi.z);
        const BsdfValueLanes f = evaluate(wi);
        return {wi, f.value / f.pdf, f.pdf, there};
    }
};

/// MetalBsdf, rough, of many bounces.
struct DullLobe {
    FacetLobe facets;
    Vec3Lanes lost_reflectance;
    Floats average;
    GgxAlbedoRow albedo;
    Floats total;              ///< Albedo of the facets.
    Floats facet_probability;  ///< As metal.cpp has it.

    template <typename Path>
    HWY_INLINE DullLobe(const Path& path, const Vec3Lanes& wo) : facets(path, wo), albedo(facets.ggx.alpha) {
        const FourLanes lost = path.numbers(1);
        lost_reflectance = lost.xyz();
        average = lost.w;
        total = albedo.total(upper(wo).z);
        const Floats from_facets = max_component(facets.reflectance) * total;
        const Floats from_lost = max_component(lost_reflectance) * (all_lanes(1.0f) - total);
        facet_probability = from_facets / (from_facets + from_lost);
    }

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wi) const {
        const Vec3Lanes o = upper(facets.wo), i = upper(wi);
        const Floats facet_pdf = facets.ggx.reflection_pdf(o, half_vector(o, i));
        const Floats lost = energy_lobe(total, albedo.total(i.z), average);
        const Floats cosine_pdf = all_lanes(kInvPi) * i.z;
        return {facets.reflectance * (facets.ggx.g2_over_g1(o, i) * facet_pdf) + lost_reflectance * (lost * cosine_pdf),
                mix(cosine_pdf, facet_pdf, facet_probability)};
    }
    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
        const Vec3Lanes o = upper(facets.wo);
        const Vec2Lanes u = numbers.direction();
        const FloatMask from_facets = hn::Lt(numbers.lobe(), facet_probability);
        Vec3Lanes wi = select(from_facets, reflect(o, facets.ggx.sample_visible(o, u)), sample_cosine_hemisphere(u));
        const FloatMask there = hn::AndNot(is_black(facets.reflectance), hn::And(positive(wi.z), finite(wi)));
        wi.z = negated_where(below_zero(facets.wo.z), wi.z);
        const BsdfValueLanes f = evaluate(wi);
        return {wi, f.value / f.pdf, f.pdf, there};
    }
};

/// MetalBsdf, smooth.
struct MirrorLobe {
    Vec3Lanes wo, reflectance;

    template <typename Path>
    HWY_INLINE MirrorLobe(const Path& path, const Vec3Lanes& towards)
        : wo(towards), reflectance(path.numbers(0).xyz()) {}

    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers&) const {
        return {{hn::Neg(wo.x), hn::Neg(wo.y), wo.z}, reflectance, all_lanes(1.0f), hn::Not(is_black(reflectance))};
    }
};

/// DielectricBsdf, smooth.
struct GlassLobe {
    Vec3Lanes wo, tint;
    Floats ior;

    template <typename Path>
    HWY_INLINE GlassLobe(const Path& path, const Vec3Lanes& towards) : wo(towards) {
        const FourLanes all = path.numbers(0);
        tint = all.xyz();
        ior = all.w;
    }

    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
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
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
