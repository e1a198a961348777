#pragma once

#include "core/math/vec.h"

#include <bit>
#include <cmath>
#include <limits>

namespace rayuela {

/// Unit roundoff of float, 2^-24.
inline constexpr float kUnitRoundoff = 0x1p-24f;

/// Bound on the relative error of n rounded operations (Higham, "Accuracy and Stability", lemma 3.1).
constexpr float gamma(int n) {
    return static_cast<float>(n) * kUnitRoundoff / (1 - static_cast<float>(n) * kUnitRoundoff);
}

inline float next_up(float x) {
    return std::nextafter(x, std::numeric_limits<float>::infinity());
}

inline float next_down(float x) {
    return std::nextafter(x, -std::numeric_limits<float>::infinity());
}

/// Origin for a ray leaving `p` towards `w`: moved along the geometric normal `n` (unit) to the side of `w`, just beyond
/// the box p +- error in which the true surface point lies, and rounded away from it.
/// `error` is an absolute bound per component, not negative. pbrt-v4 6.8.6.
inline Vec3 offset_ray_origin(const Vec3& p, const Vec3& error, const Vec3& n, const Vec3& w) {
    const float distance = glm::dot(glm::abs(n), error);
    const Vec3 offset = glm::dot(w, n) < 0 ? -distance * n : distance * n;
    Vec3 origin = p + offset;
    for (int axis = 0; axis < 3; ++axis) {
        if (offset[axis] > 0) origin[axis] = next_up(origin[axis]);
        if (offset[axis] < 0) origin[axis] = next_down(origin[axis]);
    }
    return origin;
}

}  // namespace rayuela
