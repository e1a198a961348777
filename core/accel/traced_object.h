#pragma once

#include "core/accel/accelerator.h"
#include "core/math/precise.h"
#include "core/shapes/intersect_box.h"
#include "core/shapes/intersect_plane.h"
#include "core/shapes/intersect_sphere.h"
#include "core/shapes/intersect_triangle.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace rayuela {

/// An instance as rays meet it: its transform is part of the shape where that costs no accuracy, else rays are taken to
/// the shape's own space (in double, t unchanged). List, kd-tree and surface_point all use this one form.
using TriangleCorners = std::array<Vec3, 3>;
using QuadCorners = std::array<Vec3, 4>;

TriangleCorners world_triangle(const Triangle& triangle, const Affine& to_world);
QuadCorners world_quad(const Quad& quad, const Affine& to_world);
PlaneD world_plane(const Plane& plane, const Affine& to_world);
/// Where the transform keeps a sphere a sphere (to one part in a million).
std::optional<SphereD> world_sphere(const Sphere& sphere, const Affine& to_world);
/// Where the transform is a translation and positive scales along the axes.
std::optional<Box> world_box(const Box& box, const Affine& to_world);

struct TracedObject {
    std::variant<SphereD, PlaneD, Box, TriangleCorners, QuadCorners, std::shared_ptr<const TriangleMesh>> shape;
    bool in_world = true;  ///< Rays need no transform.
    AffineD to_local;      ///< Where !in_world.

    explicit TracedObject(const GeometryInstance& instance);

    /// Null for all shapes but a mesh.
    const TriangleMesh* mesh() const;
    bool is_plane() const { return std::holds_alternative<PlaneD>(shape); }
};

/// A ray in both forms that shapes want. Without a value when the ray can meet nothing (see Accelerator).
struct TracedRay {
    RayD ray;
    TriangleRay triangle_ray;

    explicit TracedRay(const RayD& r) : ray(r), triangle_ray(r) {}
};

/// False for a ray that misses by contract: NaN or infinite, without direction, or t_min > t_max.
inline bool can_hit(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3(0) && ray.t_min <= ray.t_max;
}

/// First hit of a shape that is no mesh, in `range`; false for a mesh.
bool intersect_shape(const TracedObject& object, const TracedRay& world, const TRange& range, ShapeHit& hit);

/// Makes `hit` the best one if it comes before it.
inline void keep_closer(const ShapeHit& hit, std::uint32_t object, std::uint32_t primitive, Hit& best) {
    const Hit candidate{hit.t, hit.u, hit.v, object, primitive, hit.t_rest};
    if (is_closer(candidate, best)) best = candidate;
}

/// Where a hit must lie to come before `best`.
inline float t_end(const Ray& ray, const Hit& best) {
    return std::min(ray.t_max, best.t);
}

/// Makes the hit of the ray with an object that is no mesh the best one if it comes before it.
inline void intersect_object(std::span<const TracedObject> objects, std::uint32_t index, const Ray& ray, Hit& best) {
    ShapeHit hit;
    if (intersect_shape(objects[index], TracedRay(RayD(ray)), {ray.t_min, t_end(ray, best)}, hit))
        keep_closer(hit, index, hit.primitive, best);
}

/// World bounds of an object whose shape has `local` bounds; contains every point of it.
Bounds3 world_bounds(const TracedObject& object, const GeometryInstance& instance, const Bounds3& mesh_bounds);

/// Of the positions that triangles use, leaving out triangles that are not finite (no ray can meet them).
Bounds3 bounds_of_triangles(const TriangleMesh& mesh);

/// The box rounded outward to float.
Bounds3 round_outward(const Vec3d& lo, const Vec3d& hi);

}  // namespace rayuela
