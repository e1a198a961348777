#include "core/materials/principled.h"

#include "core/materials/fresnel.h"
#include "core/math/sampling.h"

#include <array>

namespace rayuela {
namespace {

template <typename T>
T schlick(const T& f0, float cosine) {
    return f0 + (T(1) - f0) * schlick_weight(std::fmin(cosine, 1.0f));
}

enum Lobe { kCoat, kFacets, kBody, kThroughFacets, kThroughBody, kLobeCount };

/// What depends on wo alone: how much light each lobe scatters, and so how often it is drawn.
struct Split {
    GgxAlbedo facets;
    float below_coat;  ///< What the coat leaves.
    std::array<Color, kLobeCount> albedo;
    std::array<float, kLobeCount> probability;

    Split(const PrincipledBsdf& b, float cos_o) {
        facets = ggx_albedo(cos_o, b.facets.alpha);
        const float coat = b.coat > 0 ? b.coat * ggx_albedo(cos_o, b.coat_facets.alpha).with_facets(kCoatF0) : 0.0f;
        below_coat = 1 - coat;
        const float lost = 1 - facets.total;
        albedo[kCoat] = Color(coat);
        albedo[kFacets] = below_coat * facets.with_facets(b.facets_f0);
        albedo[kBody] = below_coat * (b.metal_lost * lost + b.diffuse * (1 - facets.with_facets(b.dielectric_f0)));
        albedo[kThroughFacets] = below_coat * (1 - b.dielectric_f0) * (facets.total - facets.grazing) * b.transmission;
        albedo[kThroughBody] = below_coat * lost * b.transmission;

        float sum = 0;
        for (int i = 0; i < kLobeCount; ++i) sum += probability[i] = albedo[i].x + albedo[i].y + albedo[i].z;
        for (float& p : probability) p /= sum;
    }

    /// The lobe at `u` in [0, 1); never one of probability 0.
    Lobe choose(float u) const {
        int last = kCoat;
        for (int i = 0; i < kLobeCount; ++i) {
            if (probability[i] == 0) continue;
            last = i;
            if (u < probability[i]) break;
            u -= probability[i];
        }
        return static_cast<Lobe>(last);
    }
};

}  // namespace

PrincipledBsdf Principled::bsdf(const Vec2& uv) const {
    const Color base = clamp_unit(evaluate(base_color, uv));
    const float metal = clamp_unit(evaluate(metallic, uv)), through = clamp_unit(evaluate(transmission, uv));
    PrincipledBsdf b;
    b.facets.alpha = alpha_of(evaluate(roughness, uv));
    b.average = ggx_average_albedo(b.facets.alpha);
    b.dielectric_f0 = fresnel_normal(ior);
    b.facets_f0 = glm::mix(Color(b.dielectric_f0), base, metal);
    b.diffuse = (1 - metal) * (1 - through) * base;
    b.transmission = (1 - metal) * through * base;
    if (metal > 0 && !b.facets.is_smooth()) {
        const Color mean_fresnel = base + (1.0f - base) / 21.0f;
        b.metal_lost = metal * lost_reflectance(mean_fresnel, b.average.total);
    }
    b.coat = clamp_unit(clearcoat);
    b.coat_facets.alpha = alpha_of(clearcoat_roughness);
    return b;
}

bool Principled::is_specular_only() const {
    const bool no_body = metallic.value == 1 && !metallic.texture;
    const bool clear_body = transmission.value == 1 && !transmission.texture;
    return is_smooth_everywhere(roughness) && (no_body || clear_body) &&
           (clearcoat == 0 || alpha_of(clearcoat_roughness) < kSmoothAlpha);
}

bool PrincipledBsdf::has_smooth_lobe() const {
    return !facets.is_smooth() || !is_black(diffuse) || (coat > 0 && !coat_facets.is_smooth());
}

BsdfValue PrincipledBsdf::evaluate(const Vec3& wo, const Vec3& wi) const {
    if (wo.z == 0 || wi.z == 0 || !has_smooth_lobe()) return {};
    const bool reflects = wo.z * wi.z > 0;
    const Vec3 o = upper(wo), i = upper(wi);
    const Vec3 m = half_vector(o, i);             // of light that passes: as if it had been reflected
    const float o_m = 0.5f * glm::length(o + i);  // the same for wo and wi to the last bit
    const Split split(*this, o.z);
    const GgxAlbedo facets_i = ggx_albedo(i.z, facets.alpha);
    const float lost = energy_lobe(split.facets.total, facets_i.total, average.total);
    const float cosine_pdf = kInvPi * i.z;
    const float facet_pdf = facets.is_smooth() ? 0.0f : facets.reflection_pdf(o, m);
    const float facet_weight = facets.is_smooth() ? 0.0f : facets.g2_over_g1(o, i) * facet_pdf;

    if (!reflects) {
        return {
            split.below_coat * transmission * ((1 - schlick(dielectric_f0, o_m)) * facet_weight + lost * cosine_pdf),
            split.probability[kThroughFacets] * facet_pdf + split.probability[kThroughBody] * cosine_pdf};
    }
    const float under_facets = energy_lobe(split.facets.with_facets(dielectric_f0), facets_i.with_facets(dielectric_f0),
                                           average.with_facets(dielectric_f0));
    const Color body = metal_lost * lost + diffuse * under_facets;
    BsdfValue f{split.below_coat * (schlick(facets_f0, o_m) * facet_weight + body * cosine_pdf),
                split.probability[kFacets] * facet_pdf + split.probability[kBody] * cosine_pdf};
    if (coat > 0 && !coat_facets.is_smooth()) {
        const float coat_pdf = coat_facets.reflection_pdf(o, m);
        f.value += Color(coat * schlick(kCoatF0, o_m) * coat_facets.g2_over_g1(o, i) * coat_pdf);
        f.pdf += split.probability[kCoat] * coat_pdf;
    }
    return f;
}

std::optional<BsdfSample> PrincipledBsdf::sample(const Vec3& wo, float u_lobe, const Vec2& u) const {
    const Vec3 o = upper(wo);
    const Split split(*this, o.z);
    const Lobe lobe = split.choose(u_lobe);
    const bool passes = lobe == kThroughFacets || lobe == kThroughBody;
    const bool from_body = lobe == kBody || lobe == kThroughBody;
    const Ggx& ggx = lobe == kCoat ? coat_facets : facets;
    const bool mirrors = !from_body && ggx.is_smooth();

    Vec3 wi;
    if (from_body) {
        wi = sample_cosine_hemisphere(u);
    } else {
        wi = mirrors ? Vec3(-o.x, -o.y, o.z) : reflect(o, ggx.sample_visible(o, u));
    }
    if (!(wi.z > 0)) return std::nullopt;
    if (passes != (wo.z < 0)) wi.z = -wi.z;
    if (mirrors) return mirrored(wi, split.albedo[lobe] / split.probability[lobe], split.probability[lobe]);
    const BsdfValue f = evaluate(wo, wi);
    return scattered(wi, f.value / f.pdf, f.pdf);
}

}  // namespace rayuela
