#include "core/materials/dielectric.h"

#include "core/materials/fresnel.h"

namespace rayuela {
namespace {

/// `w` refracted at a boundary of normal m (on w's side) into a medium of relative index eta; total reflection excluded.
Vec3 refract(const Vec3& w, const Vec3& m, float eta) {
    const float cos_i = glm::dot(w, m);
    const float cos_t = std::sqrt(std::fmax((eta - 1) * (eta + 1) + cos_i * cos_i, 0.0f)) / eta;
    return glm::normalize((cos_i / eta - cos_t) * m - w / eta);
}

}  // namespace

DielectricBsdf Dielectric::bsdf(const Vec2& uv) const {
    return {ior, clamp_unit(evaluate(tint, uv)), {alpha_of(evaluate(roughness, uv))}};
}

BsdfValue DielectricBsdf::evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!has_smooth_lobe() || wo.z * wi.z == 0) return {};
    const double eta = wo.z > 0 ? double{ior} : 1 / double{ior};
    const bool reflects = wo.z * wi.z > 0;
    const Vec3 o = upper(wo), i = upper(wi);

    // In double: the facet of a refraction follows from a difference of directions.
    const Vec3d od = glm::normalize(Vec3d(o)), id = glm::normalize(Vec3d(i.x, i.y, reflects ? i.z : -i.z));
    const Vec3d half = reflects ? od + id : od + eta * id;
    const Vec3d md = glm::normalize(half.z < 0 ? -half : half);
    const double o_m = glm::dot(od, md), i_m = glm::dot(id, md);
    if (!(o_m > 0) || reflects != (i_m > 0)) return {};  // facets seen from behind

    const Vec3 m(md);
    const double fresnel = fresnel_dielectric(std::fmin(o_m, 1.0), eta);
    double pdf = 0;
    if (reflects) {
        pdf = fresnel * ggx.reflection_pdf(o, m);
    } else {
        const double scale = i_m + o_m / eta;  // of half vectors to directions, Walter's eq. 17
        const double jacobian = -i_m / (scale * scale);
        pdf = (1 - fresnel) * ggx.reflection_pdf(o, m) * 4 * o_m * jacobian;
    }
    return {tint * (ggx.g1(i) * static_cast<float>(pdf)), static_cast<float>(pdf)};
}

std::optional<BsdfSample> DielectricBsdf::sample(const Vec3& wo, float u_lobe, const Vec2& u) const {
    const bool smooth = !has_smooth_lobe();
    const float eta = wo.z > 0 ? ior : 1 / ior;
    const Vec3 o = upper(wo);
    const Vec3 m = smooth ? Vec3(0, 0, 1) : ggx.sample_visible(o, u);
    const auto fresnel = static_cast<float>(fresnel_dielectric(glm::clamp(glm::dot(o, m), 0.0f, 1.0f), eta));
    const bool reflects = u_lobe < fresnel;

    Vec3 wi = reflects ? reflect(o, m) : refract(o, m, eta);
    if (reflects != (wi.z > 0)) return std::nullopt;
    if (wo.z < 0) wi.z = -wi.z;
    if (smooth) return mirrored(wi, tint, reflects ? fresnel : 1 - fresnel, reflects ? 1 : eta);
    const BsdfValue f = evaluate(wo, wi);
    return scattered(wi, f.value / f.pdf, f.pdf);
}

}  // namespace rayuela
