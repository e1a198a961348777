#pragma once

#include "core/lights/light_sample.h"
#include "core/materials/material.h"
#include "core/math/transform.h"

#include <memory>
#include <optional>

namespace rayuela {

/// Emission that varies over a light.
struct EmissionTexture {
    Material material;
    Mat3 sphere_to_local{1};  ///< World direction from a sphere's centre -> its own space.
    Vec2 uv_origin{0}, uv_u{1, 0},
        uv_v{0, 1};  ///< Texture coordinates at the origin and along the edges of the others.
};

/// A piece of an emissive surface, in world space.
struct AreaLight {
    enum class Kind : std::uint8_t { sphere, triangle, parallelogram };

    Kind kind = Kind::triangle;
    bool two_sided = false;
    Vec3 origin{0};     ///< Centre of a sphere, else a corner.
    Vec3 u{0}, v{0};    ///< Edges from the corner.
    Vec3 normal{0};     ///< Unit, of the front; unused for a sphere.
    float size = 0;     ///< Radius of a sphere, else area.
    Color radiance{0};  ///< Where it does not vary; else its mean over the surface.
    std::shared_ptr<const EmissionTexture> texture;

    float area() const;
    /// Emitted flux, mean over the channels.
    float power() const;

    /// A point of the light that shines towards `p`, and its density per solid angle at p.
    std::optional<LightSample> sample(const Vec3& p, const Vec2& u) const;
    /// Density with which `sample` draws the unit direction `wi`, which meets this light at `hit_point` with unit front
    /// normal `ng`.
    float pdf(const Vec3& p, const Vec3& wi, const Vec3& hit_point, const Vec3& ng) const;
};

}  // namespace rayuela
