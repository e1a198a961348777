#include "core/materials/diffuse.h"

#include "core/materials/microfacet.h"
#include "core/math/sampling.h"

namespace rayuela {

DiffuseBsdf Diffuse::bsdf(const Vec2& uv) const {
    return {clamp_unit(evaluate(albedo, uv))};
}

BsdfValue DiffuseBsdf::evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!(wo.z * wi.z > 0)) return {};
    const float pdf = kInvPi * std::abs(wi.z);
    return {albedo * pdf, pdf};
}

std::optional<BsdfSample> DiffuseBsdf::sample(const Vec3& wo, float, const Vec2& u) const {
    if (is_black(albedo)) return std::nullopt;
    Vec3 wi = sample_cosine_hemisphere(u);
    if (wo.z < 0) wi.z = -wi.z;
    return scattered(wi, albedo, kInvPi * std::abs(wi.z));
}

}  // namespace rayuela
