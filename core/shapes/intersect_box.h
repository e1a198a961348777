#pragma once

#include "core/math/precise.h"
#include "core/shapes/box.h"
#include "core/shapes/shape_hit.h"

#include <cmath>

namespace rayuela {

/// Face of a box: 2 * axis for the side of `min`, 2 * axis + 1 for the side of `max`.
inline std::uint32_t box_face(int axis, bool max_side) {
    return static_cast<std::uint32_t>(2 * axis + (max_side ? 1 : 0));
}

/// First hit in `range`, entering or leaving; ShapeHit::primitive is the face. Slabs in double; rays that touch an edge
/// within the rounding of the slabs hit, so that none slips between two boxes that share one.
inline bool intersect_box(const Box& box, const RayD& ray, const TRange& range, ShapeHit& hit) {
    double enter = -INFINITY, leave = INFINITY;
    std::uint32_t enter_face = 0, leave_face = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double o = ray.origin[axis], d = ray.direction[axis];
        const double lo = box.min[axis], hi = box.max[axis];
        if (d == 0) {
            if (!(o >= lo && o <= hi)) return false;
            continue;
        }
        const double t_near = ((d > 0 ? lo : hi) - o) / d;
        const double t_far = ((d > 0 ? hi : lo) - o) / d;
        if (t_near > enter) {
            enter = t_near;
            enter_face = box_face(axis, d < 0);
        }
        if (t_far < leave) {
            leave = t_far;
            leave_face = box_face(axis, d > 0);
        }
    }
    constexpr double kRounding = 0x1p-50;
    if (!(enter - leave <= kRounding * std::fmax(std::fabs(enter), std::fabs(leave)))) return false;

    const float first = static_cast<float>(enter), second = static_cast<float>(leave);
    if (range.contains(first)) {
        hit = {.t = first, .primitive = enter_face};
    } else if (range.contains(second)) {
        hit = {.t = second, .primitive = leave_face};
    } else {
        return false;
    }
    return true;
}

}  // namespace rayuela
