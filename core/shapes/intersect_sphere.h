#pragma once

#include "core/math/precise.h"
#include "core/shapes/shape_hit.h"

#include <cmath>
#include <utility>

namespace rayuela {

/// A sphere in double: its transform may be part of it.
struct SphereD {
    Vec3d center{0};
    double radius = 1;
};

/// Closer than this to the surface, in radii, distance - radius is what the roundings have left of it.
inline constexpr double kSphereCancels = 0x1p-20;

/// First hit in `range`. Solved in double with the discriminant from the point of closest approach and the roots without
/// cancellation (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019): a float
/// solve of a ground sphere is wrong by more than its t.
inline bool intersect_sphere(const SphereD& sphere, const RayD& ray, const TRange& range, ShapeHit& hit) {
    const Vec3d& d = ray.direction;
    const Vec3d from_center = ray.origin - sphere.center;
    const double a = glm::dot(d, d);
    const double b = -glm::dot(from_center, d);
    const double closest = glm::length(from_center + (b / a) * d);
    const double discriminant = (sphere.radius - closest) * (sphere.radius + closest);
    if (!(discriminant >= 0)) return false;

    const double distance = glm::length(from_center);
    double c = (distance - sphere.radius) * (distance + sphere.radius);
    if (std::fabs(distance - sphere.radius) <= kSphereCancels * sphere.radius)
        c = squared_distance_excess(ray.origin, sphere.center, sphere.radius);
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    double t0 = q == 0 ? 0 : c / q;
    double t1 = q / a;
    if (t0 > t1) std::swap(t0, t1);

    const float first = static_cast<float>(t0), second = static_cast<float>(t1);
    if (!range.contains(first) && !range.contains(second)) return false;
    hit = {.t = range.contains(first) ? first : second};
    return true;
}

}  // namespace rayuela
