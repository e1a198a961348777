#pragma once

#include "core/materials/material.h"
#include "core/math/vec.h"

#include <optional>

namespace rayuela {

/// A direction drawn from a Bsdf.
struct BsdfSample {
    Vec3 wi{0};
    Color weight{0};        ///< eval / pdf, cosine included; for a delta lobe the ratio of the two deltas.
    float pdf = 0;          ///< Per solid angle; of a delta lobe: the probability of having chosen it.
    bool specular = false;  ///< From a delta lobe: no light sampling can find it.
};

/// A material at one point: textures evaluated, parameters clamped, pure from here on. Directions are unit, in the local
/// frame whose +z is the shading normal on the side of the geometric front, and point away from the surface.
class Bsdf {
public:
    /// f(wo, wi) * |cos(wi)|; delta lobes contribute nothing.
    Color eval(const Vec3& wo, const Vec3& wi) const;
    /// Density per solid angle with which `sample` draws wi; delta lobes contribute nothing.
    float pdf(const Vec3& wo, const Vec3& wi) const;
    /// `u_lobe` in [0, 1) chooses among lobes, `u` in [0, 1)^2 a direction. Nothing where all light is absorbed.
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    /// Whether any lobe is not a delta: only then can a light sample contribute.
    bool has_smooth_lobe() const;
};

/// The material at texture coordinates uv. Which side wo is on decides between entering and leaving.
Bsdf make_bsdf(const Material& material, const Vec2& uv);

/// Radiance leaving the surface towards a viewer on its front or back.
Color emitted(const Material& material, const Vec2& uv, bool front);

/// Whether `emitted` can be other than black.
bool is_emissive(const Material& material);
/// Whether the back emits as well.
bool emits_two_sided(const Material& material);

}  // namespace rayuela
