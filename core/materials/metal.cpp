#include "core/materials/metal.h"

#include "core/materials/ggx_albedo.h"
#include "core/math/sampling.h"

namespace rayuela {
namespace {

/// How often a direction is drawn from the facets rather than from the cosine lobe of what they lose.
float facet_probability(const MetalBsdf& bsdf, float total) {
    const float facets = max_component(bsdf.reflectance) * total;
    const float lost = max_component(bsdf.lost_reflectance) * (1 - total);
    return facets / (facets + lost);
}

}  // namespace

MetalBsdf Metal::bsdf(const Vec2& uv) const {
    MetalBsdf bsdf;
    bsdf.reflectance = clamp_unit(evaluate(albedo, uv));
    bsdf.ggx.alpha = alpha_of(evaluate(roughness, uv));
    bsdf.multiscatter = multiscatter && !bsdf.ggx.is_smooth();
    if (bsdf.multiscatter) {
        bsdf.average_albedo = ggx_average_albedo(bsdf.ggx.alpha).total;
        bsdf.lost_reflectance = lost_reflectance(bsdf.reflectance, bsdf.average_albedo);
    }
    return bsdf;
}

BsdfValue MetalBsdf::evaluate(const Vec3& wo, const Vec3& wi) const {
    if (ggx.is_smooth() || !(wo.z * wi.z > 0)) return {};
    const Vec3 o = upper(wo), i = upper(wi);
    const float facet_pdf = ggx.reflection_pdf(o, half_vector(o, i));
    if (!multiscatter) return {reflectance * (ggx.g1(i) * facet_pdf), facet_pdf};

    const float total = ggx_albedo(o.z, ggx.alpha).total;
    const float lost = energy_lobe(total, ggx_albedo(i.z, ggx.alpha).total, average_albedo);
    const float cosine_pdf = kInvPi * i.z;
    return {reflectance * (ggx.g2_over_g1(o, i) * facet_pdf) + lost_reflectance * (lost * cosine_pdf),
            glm::mix(cosine_pdf, facet_pdf, facet_probability(*this, total))};
}

std::optional<BsdfSample> MetalBsdf::sample(const Vec3& wo, float u_lobe, const Vec2& u) const {
    if (is_black(reflectance)) return std::nullopt;
    if (ggx.is_smooth()) return mirrored(Vec3(-wo.x, -wo.y, wo.z), reflectance, 1);

    const Vec3 o = upper(wo);
    const bool from_facets = !multiscatter || u_lobe < facet_probability(*this, ggx_albedo(o.z, ggx.alpha).total);
    Vec3 wi = from_facets ? reflect(o, ggx.sample_visible(o, u)) : sample_cosine_hemisphere(u);
    if (wi.z <= 0) return std::nullopt;
    if (wo.z < 0) wi.z = -wi.z;
    const BsdfValue f = evaluate(wo, wi);
    return scattered(wi, f.value / f.pdf, f.pdf);
}

}  // namespace rayuela
