// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_PRINCIPLED_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_PRINCIPLED_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_PRINCIPLED_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_PRINCIPLED_LANES_INL_H_
#endif

#include "core/materials/bsdf_lanes-inl.h"
#include "core/materials/ggx_albedo_lanes-inl.h"

// The Bsdf of principled.cpp: see bsdf_lanes-inl.h.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// PrincipledBsdf without smooth parts. kTransmits: some light may pass.
template <bool kTransmits>
struct PrincipledLobe {
    Vec3Lanes wo;
    GgxLanes facets, coat_facets;
    Floats coat, dielectric_f0;
    Vec3Lanes facets_f0, metal_lost, diffuse, transmission;
    GgxAlbedoLanes average;
    GgxAlbedoRow albedo;

    // What depends on wo: Split of principled.cpp.
    static constexpr std::size_t kLobes = kTransmits ? 5 : 3;
    GgxAlbedoLanes facets_o;
    Floats below_coat;
    Floats probability[kLobes];

    template <typename Path>
    HWY_INLINE PrincipledLobe(const Path& path, const Vec3Lanes& towards)
        : PrincipledLobe(path, towards, path.numbers(0)) {}

    HWY_INLINE BsdfValueLanes evaluate(const Vec3Lanes& wi) const {
        const Floats one = all_lanes(1.0f);
        const Vec3Lanes o = upper(wo), i = upper(wi), m = half_vector(o, i), sum = o + i;
        const Floats o_m = all_lanes(0.5f) * hn::Sqrt(dot(sum, sum));
        const Floats weight = schlick_weight(hn::Min(o_m, one));
        const GgxAlbedoLanes facets_i = albedo.at(i.z);
        const Floats lost = energy_lobe(facets_o.total, facets_i.total, average.total);
        const Floats cosine_pdf = all_lanes(kInvPi) * i.z;
        const Floats facet_pdf = facets.reflection_pdf(o, m), facet_weight = facets.g2_over_g1(o, i) * facet_pdf;
        const Floats under_facets =
            energy_lobe(facets_o.with_facets(dielectric_f0), facets_i.with_facets(dielectric_f0),
                        average.with_facets(dielectric_f0));
        const Vec3Lanes body = metal_lost * lost + diffuse * under_facets;
        const Vec3Lanes fresnel{schlick(facets_f0.x, weight), schlick(facets_f0.y, weight),
                                schlick(facets_f0.z, weight)};
        BsdfValueLanes f{(fresnel * facet_weight + body * cosine_pdf) * below_coat,
                         probability[kFacets] * facet_pdf + probability[kBody] * cosine_pdf};
        const FloatMask coated = positive(coat);
        if (!hn::AllFalse(FloatTag(), coated)) {
            const Floats pdf = coat_facets.reflection_pdf(o, m);
            const Floats added = coat * schlick(all_lanes(kCoatF0), weight) * coat_facets.g2_over_g1(o, i) * pdf;
            f.value = select(coated, f.value + Vec3Lanes{added, added, added}, f.value);
            f.pdf = hn::IfThenElse(coated, f.pdf + probability[kCoat] * pdf, f.pdf);
        }
        if constexpr (kTransmits) {
            const FloatMask reflects = positive(wo.z * wi.z);
            const Floats passing = (one - schlick(dielectric_f0, weight)) * facet_weight + lost * cosine_pdf;
            f.value = select(reflects, f.value, transmission * below_coat * passing);
            f.pdf = hn::IfThenElse(reflects, f.pdf,
                                   probability[kThroughFacets] * facet_pdf + probability[kThroughBody] * cosine_pdf);
        }
        return f;
    }

    template <typename Numbers>
    HWY_INLINE BsdfSampleLanes sample(const Numbers& numbers) const {
        const Vec3Lanes o = upper(wo);
        const Vec2Lanes u = numbers.direction();
        const Choice lobe = choose(numbers.lobe());
        const GgxLanes ggx{hn::IfThenElse(lobe.is[kCoat], coat_facets.alpha, facets.alpha)};
        Vec3Lanes wi = select(lobe.from_body(), sample_cosine_hemisphere(u), reflect(o, ggx.sample_visible(o, u)));
        const FloatMask there = hn::And(positive(wi.z), finite(wi));
        wi.z = negated_where(hn::Xor(lobe.passes(), below_zero(wo.z)), wi.z);
        const BsdfValueLanes f = evaluate(wi);
        return {wi, f.value / f.pdf, f.pdf, there};
    }

private:
    enum { kCoat, kFacets, kBody, kThroughFacets, kThroughBody };

    template <typename Path>
    HWY_INLINE PrincipledLobe(const Path& path, const Vec3Lanes& towards, const FourLanes& first)
        : wo(towards), facets{first.x}, coat_facets{first.y}, coat(first.z), dielectric_f0(first.w), albedo(first.x) {
        const FourLanes second = path.numbers(1), third = path.numbers(2);
        facets_f0 = second.xyz();
        metal_lost = third.xyz();
        average = {second.w, third.w};
        diffuse = path.numbers(3).xyz();
        if constexpr (kTransmits) transmission = path.numbers(4).xyz();
        split();
    }

    static HWY_INLINE Floats schlick(Floats f0, Floats weight) { return f0 + (all_lanes(1.0f) - f0) * weight; }
    static HWY_INLINE Floats sum_of(const Vec3Lanes& c) { return c.x + c.y + c.z; }

    HWY_INLINE void split() {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f), cos_o = upper(wo).z;
        facets_o = albedo.at(cos_o);
        Floats reflected = zero;
        const FloatMask coated = positive(coat);
        if (!hn::AllFalse(FloatTag(), coated)) {
            const Floats all = GgxAlbedoRow(coat_facets.alpha).at(cos_o).with_facets(all_lanes(kCoatF0));
            reflected = hn::IfThenElseZero(coated, coat * all);
        }
        below_coat = one - reflected;
        const Floats lost = one - facets_o.total;
        const Vec3Lanes body = metal_lost * lost + diffuse * (one - facets_o.with_facets(dielectric_f0));
        probability[kCoat] = sum_of({reflected, reflected, reflected});
        probability[kFacets] = sum_of(facets_o.with_facets(facets_f0) * below_coat);
        probability[kBody] = sum_of(body * below_coat);
        if constexpr (kTransmits) {
            const Floats through = below_coat * (one - dielectric_f0) * (facets_o.total - facets_o.grazing);
            probability[kThroughFacets] = sum_of(transmission * through);
            probability[kThroughBody] = sum_of(transmission * (below_coat * lost));
        }
        Floats sum = zero;
        for (const Floats& p : probability) sum = sum + p;
        for (Floats& p : probability) p = p / sum;
    }

    struct Choice {
        FloatMask is[kLobes];

        HWY_INLINE FloatMask from_body() const {
            if constexpr (kTransmits) return hn::Or(is[kBody], is[kThroughBody]);
            return is[kBody];
        }
        HWY_INLINE FloatMask passes() const {
            if constexpr (kTransmits) return hn::Or(is[kThroughFacets], is[kThroughBody]);
            return hn::FirstN(FloatTag(), 0);
        }
    };

    /// As Split::choose.
    HWY_INLINE Choice choose(Floats u) const {
        const FloatTag d;
        const FloatMask none = hn::FirstN(d, 0);
        Choice choice;
        for (FloatMask& is : choice.is) is = none;
        choice.is[kCoat] = hn::Not(none);
        FloatMask open = choice.is[kCoat];
        for (std::size_t i = 0; i < kLobes; ++i) {
            const FloatMask here = hn::And(open, hn::Ne(probability[i], hn::Zero(d)));
            for (FloatMask& is : choice.is) is = hn::AndNot(here, is);
            choice.is[i] = hn::Or(choice.is[i], here);
            const FloatMask ends = hn::And(here, hn::Lt(u, probability[i]));
            u = hn::IfThenElse(here, u - probability[i], u);
            open = hn::AndNot(ends, open);
        }
        return choice;
    }
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
