#pragma once

#include "core/accel/surface_point.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace rayuela {

/// A hit of a triangle, be it one of a quad or a mesh: what its SurfacePoint is made from.
struct FlatHit {
    Vec3d a, b, c;      ///< The corners in the world.
    double b1, b2;      ///< Barycentric coordinates of b and c.
    double sign;        ///< Positive where the corners are counter-clockwise seen from the front, else -1.
    double offset = 0;  ///< Largest of the numbers that the corners were made from beside themselves.
};

/// Many of them, as a structure of arrays.
struct FlatBlock {
    static constexpr std::size_t kSize = 64;
    using Row = double[kSize];

    std::size_t size = 0;
    alignas(64) Row a[3];
    Row b[3], c[3];
    Row b1, b2, sign, offset;
    std::uint32_t ray[kSize];

    void push(const FlatHit& hit, std::size_t of_ray) {
        for (int axis = 0; axis < 3; ++axis) {
            a[axis][size] = hit.a[axis];
            b[axis][size] = hit.b[axis];
            c[axis][size] = hit.c[axis];
        }
        b1[size] = hit.b1;
        b2[size] = hit.b2;
        sign[size] = hit.sign;
        offset[size] = hit.offset;
        ray[size++] = static_cast<std::uint32_t>(of_ray);
    }
};

/// points[block.ray[k]] becomes what Surfaces::point gives for the hit, without uv and interpolated normal and to the last
/// bit, many at once.
void flat_points(const FlatBlock& block, std::span<SurfacePoint> points);

}  // namespace rayuela
