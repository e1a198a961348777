#pragma once

#include "core/accel/surface_point.h"
#include "core/lights/light_importance.h"
#include "core/math/basis.h"
#include "core/math/float_error.h"
#include "core/render/render_scene.h"

#include <optional>

namespace rayuela {

/// A hit with everything that shading asks for, as seen from where a path came. Keeps references to what it was made of.
class Interaction {
public:
    /// `wo` is unit, towards where the path came from. `varies`: the Bsdf has to be worked out here.
    Interaction(const SurfacePoint& surface, const PackedMaterial& packed, const Vec3& towards)
        : Interaction(surface, packed, towards, packed.textured) {}
    Interaction(const SurfacePoint& surface, const PackedMaterial& packed, const Vec3& towards, bool varies)
        : point(surface),
          material(packed),
          wo(towards),
          frame(shading_normal(towards)),
          wo_local(frame.to_local(towards)),
          varying_(varies ? std::optional(make_bsdf(packed.material, surface.uv)) : std::nullopt) {}

    const SurfacePoint& point;
    const PackedMaterial& material;
    Vec3 wo;
    Basis frame;  ///< Around the shading normal.
    Vec3 wo_local;

    const Bsdf& bsdf() const { return varying_ ? *varying_ : material.bsdf; }
    bool front() const { return glm::dot(wo, point.ng) > 0; }
    /// Whether shading and geometric normal agree on which side `wi` leaves: else light would leak through the surface.
    bool consistent(const Vec3& wi, const Vec3& wi_local) const { return glm::dot(wi, point.ng) * wi_local.z > 0; }
    /// Whether seen from `wi` the shading normal is the same.
    bool same_frame(const Vec3& wi) const { return shading_normal(wi) == frame.n; }
    Vec3 ray_origin(const Vec3& wi) const { return offset_ray_origin(point.p, point.p_error, point.ng, wi); }
    LightReceiver receiver() const { return {point.p, receiver_normal()}; }
    /// LightReceiver::n.
    Vec3 receiver_normal() const {
        if (material.transmits) return Vec3(0);
        return wo_local.z < 0 ? -frame.n : frame.n;
    }
    /// Of the angle between `w` and the geometric normal, not negative.
    float cosine(const Vec3& w) const { return std::abs(glm::dot(w, point.ng)); }

private:
    /// Seen from beyond its own horizon an interpolated normal says nothing; the flat one stands in.
    const Vec3& shading_normal(const Vec3& w) const {
        return (glm::dot(w, point.ng) > 0) == (glm::dot(w, point.ns) > 0) ? point.ns : point.ng;
    }

    std::optional<Bsdf> varying_;  ///< Where the material is textured.
};

}  // namespace rayuela
