#pragma once

#include "core/accel/surface_point.h"
#include "core/shapes/intersect_sphere.h"

namespace rayuela {

/// A hit of a sphere that stands in the world.
struct SphereHit {
    std::uint32_t ray, sphere;
};

/// points[found[k].ray] becomes what Surfaces::point gives for that ray and hit and the sphere, without uv and to the last
/// bit, many at once.
void sphere_points(std::span<const SphereD> spheres, std::span<const SphereHit> found, std::span<const Ray> rays,
                   std::span<const Hit> hits, std::span<SurfacePoint> points);

}  // namespace rayuela
