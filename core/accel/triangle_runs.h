#pragma once

#include "core/math/bounds.h"

#include <array>
#include <span>

namespace rayuela {

/// Triangles of a leaf side by side: kTriangleRuns runs of one float a triangle: x, y, z of the three vertices, then the
/// largest extent along an axis. The kernels may read up to kRunPadding floats too far.
inline constexpr std::size_t kTriangleRuns = 10, kRunPadding = 64;

/// Writes triangle i of n.
inline void write_triangle(const std::array<Vec3, 3>& vertices, std::size_t i, std::size_t n, float* runs) {
    Bounds3 bounds;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis)
            runs[(3 * corner + static_cast<std::size_t>(axis)) * n + i] = vertices[corner][axis];
        bounds.extend(vertices[corner]);
    }
    runs[9 * n + i] = max_component(bounds.extent());
}

}  // namespace rayuela
