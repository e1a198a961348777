#pragma once

#include "core/lights/light_importance.h"
#include "core/lights/light_sample.h"
#include "core/lights/rectangle_view.h"
#include "core/materials/material.h"
#include "core/math/transform.h"

#include <memory>
#include <optional>

namespace rayuela {

struct CornerWarp;
struct RectangleView;
class TriangleView;

/// Emission that varies over a light.
struct EmissionTexture {
    std::shared_ptr<const Material> material;
    Mat3 sphere_to_local{1};  ///< World direction from a sphere's centre -> its own space, but for its length.
    /// Texture coordinates at the origin of the other kinds and along their edges.
    Vec2 uv_origin{0}, uv_u{1, 0}, uv_v{0, 1};
};

/// A piece of an emissive surface, in world space.
struct AreaLight {
    enum class Kind : std::uint8_t { sphere, triangle, parallelogram };

    Kind kind = Kind::triangle;
    bool two_sided = false;
    Vec3 origin{0};             ///< Centre of a sphere, else a corner.
    Vec3 edge_u{0}, edge_v{0};  ///< Edges from the corner.
    Vec3 normal{0};             ///< Unit, of the front; unused for a sphere.
    float size = 0;             ///< Radius of a sphere, else area.
    Color radiance{0};          ///< Where it does not vary; else its mean over the surface.
    std::shared_ptr<const EmissionTexture> texture;
    /// Squares of the distances to its middle within which a flat light is near, and within which it is worth while to look
    /// at it as a rectangle or triangle; 0 where it never is.
    float near2 = 0, close2 = 0;
    RectangleFrame frame;  ///< In units of the half of its diagonal, where a parallelogram may be close.

    /// Makes it the flat light of this `kind` there: sets all that depends on its place. The front is the side that sees the
    /// edges turn from `u` to `v` counterclockwise, or the other one if `inverted`. One without area keeps normal and size 0.
    void place(Kind flat_kind, const Vec3& corner, const Vec3& u, const Vec3& v, bool inverted = false);

    float area() const;
    /// Emitted flux, mean over the channels.
    float power() const;
    /// Radiance at parametric `position` (along the edges), or where the unit normal of a sphere is this.
    Color radiance_at(const Vec2& position) const;
    Color radiance_at(const Vec3& sphere_normal) const;

    /// A point of the light that shines towards the receiver, and its density per solid angle there: spheres by the cone they
    /// fill (from inside by area), all others by area, if near by what their corners send to the receiver, and close
    /// rectangles and triangles by solid angle and the cosine at the receiver.
    std::optional<LightSample> sample(const LightReceiver& receiver, const Vec2& u) const;
    /// Density with which `sample` draws the unit direction `wi`, which meets this light at `hit_point` with unit front
    /// normal `ng`.
    float pdf(const LightReceiver& receiver, const Vec3& wi, const Vec3& hit_point, const Vec3& ng) const;

    /// A point drawn evenly over the area, seen from a side that shines.
    struct SurfaceSample {
        Vec3 point{0};
        Vec3 error{0};   ///< Bound on the distance to the true surface.
        Vec3 normal{0};  ///< Unit, on that side.
        Color radiance{0};
        float pdf = 0;  ///< Per area, the choice of the side included.
    };
    /// `u_side` chooses the side of a two-sided light.
    SurfaceSample sample_surface(const Vec2& u, float u_side) const;

    /// Bound on the rounding of a point of the light, a component each.
    Vec3 point_error() const;

    /// From the corner of a flat light to the point that (1, 1) is mapped to: the corner across, or the middle of the side
    /// across.
    Vec3 diagonal() const;

private:
    std::optional<LightSample> sample_sphere(const Vec3& p, const Vec2& u) const;
    std::optional<LightSample> sample_flat(const LightReceiver& receiver, const Vec2& u) const;
    /// Where `p` is close to it.
    std::optional<RectangleView> rectangle_view(const Vec3& p) const;
    std::optional<TriangleView> triangle_view(const Vec3& p) const;
    bool close(const Vec3& p) const;
    /// How to draw numbers for a near light.
    std::optional<CornerWarp> warp(const LightReceiver& receiver) const;
    /// The numbers that a point of a flat light is drawn by.
    Vec2 numbers_of(const Vec3& point) const;
    /// Of a drawn point: per solid angle, or where that is 0, `area` times that of a point drawn evenly over the light.
    struct Density {
        float solid_angle, area;
    };
    std::optional<LightSample> finish(const Vec3& p, const Vec3& point, const Vec3& n, const Density& density,
                                      const Color& radiance) const;
};

}  // namespace rayuela
