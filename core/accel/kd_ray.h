#pragma once

#include "core/accel/kd_tree.h"
#include "core/math/float_error.h"
#include "core/math/precise.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

/// A ray prepared for the float traversal of one kd-tree. The traversal is conservative: it reaches a leaf of every primitive
/// with which the exact tests in double find a hit, so that a tree gives the hits of a list bit for bit.
///
/// A hit point lies in a cell of the tree and off the ray, at the float t, by less than 2^-38 of the primitive + u |t d|. The
/// distance to a plane, (plane - origin) * (1 / direction), is computed within 4u |plane - origin| (rounding of the ray to
/// float, the subtraction, the reciprocal and the product) and u |origin| for the shift. Every plane is therefore passed
/// 10u (|origin| + |bounds|) early and late.
struct KdRay {
    /// t of leaving the near child = (plane - leave[axis]) * inverse[axis], of entering the far one likewise.
    std::array<float, 3> leave, enter;
    std::array<float, 3> inverse;
    /// 1 where the near child is the one above the plane.
    std::array<std::uint32_t, 3> flip;
    /// Traversal counts t in this multiple of the ray's: 1 but for directions of extreme length.
    float t_scale = 1;
    float begin = 0, end = -1;  ///< Interval in which the ray may meet the tree's bounds; empty when begin > end.

    KdRay(const RayD& ray, const Bounds3& bounds, float t_min, float t_max) {
        const Vec3d size = glm::abs(ray.direction);
        const double longest = glm::max(size.x, glm::max(size.y, size.z));
        if (!(longest > 0x1p-60 && longest < 0x1p60))
            t_scale = static_cast<float>(std::exp2(clamped_exponent(longest)));
        const Vec3 origin(ray.origin);
        const Vec3 reach = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
        const float pad = 10 * kUnitRoundoff * (max_component(glm::abs(origin)) + max_component(reach));
        begin = t_min * t_scale;
        end = t_max * t_scale;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            const double direction = ray.direction[axis] / t_scale;
            const bool backward = direction < 0;
            // Finite, so that no product is NaN: where the direction is 0 the sign of the difference decides alone.
            constexpr double kSmallest = 0x1p-100;
            const double bounded = std::fabs(direction) > kSmallest ? direction : backward ? -kSmallest : kSmallest;
            inverse[k] = static_cast<float>(1 / bounded);
            flip[k] = backward ? 1 : 0;
            leave[k] = backward ? origin[axis] + pad : origin[axis] - pad;
            enter[k] = backward ? origin[axis] - pad : origin[axis] + pad;
            const float nearest = backward ? bounds.hi[axis] : bounds.lo[axis];
            const float farthest = backward ? bounds.lo[axis] : bounds.hi[axis];
            begin = std::max(begin, (nearest - enter[k]) * inverse[k]);
            end = std::min(end, (farthest - leave[k]) * inverse[k]);
        }
    }

private:
    static double clamped_exponent(double longest) {
        return glm::clamp(longest > 0 ? std::ilogb(longest) : 0, -126, 126);
    }
};

}  // namespace rayuela
