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
    const float eta = wo.z > 0 ? ior : 1 / ior;
    const bool reflects = wo.z * wi.z > 0;
    const Vec3 o = upper(wo);
    const Vec3 i = wo.z > 0 ? wi : Vec3(wi.x, wi.y, -wi.z);

    Vec3 m = reflects ? o + i : o + eta * i;
    m = glm::normalize(m.z < 0 ? -m : m);
    const float o_m = glm::dot(o, m), i_m = glm::dot(i, m);
    if (!(o_m > 0) || reflects != (i_m > 0)) return {};  // facets seen from behind

    const float fresnel = fresnel_dielectric(std::fmin(o_m, 1.0f), eta);
    float pdf;
    if (reflects) {
        pdf = fresnel * ggx.reflection_pdf(o, m);
    } else {
        const float scale = i_m + o_m / eta;  // of half vectors to directions, Walter's eq. 17
        pdf = (1 - fresnel) * ggx.visible_pdf(o, m) * -i_m / (scale * scale);
    }
    return {tint * (ggx.g1(upper(wi)) * pdf), pdf};
}

std::optional<BsdfSample> DielectricBsdf::sample(const Vec3& wo, float u_lobe, const Vec2& u) const {
    const bool smooth = !has_smooth_lobe();
    const float eta = wo.z > 0 ? ior : 1 / ior;
    const Vec3 o = upper(wo);
    const Vec3 m = smooth ? Vec3(0, 0, 1) : ggx.sample_visible(o, u);
    const float fresnel = fresnel_dielectric(glm::clamp(glm::dot(o, m), 0.0f, 1.0f), eta);
    const bool reflects = u_lobe < fresnel;

    Vec3 wi = reflects ? reflect(o, m) : refract(o, m, eta);
    if (reflects != (wi.z > 0)) return std::nullopt;
    if (wo.z < 0) wi.z = -wi.z;
    if (smooth) return BsdfSample{wi, tint, reflects ? fresnel : 1 - fresnel, true};
    const BsdfValue f = evaluate(wo, wi);
    return BsdfSample{wi, f.value / f.pdf, f.pdf, false};
}

}  // namespace rayuela
