#pragma once

#include "core/math/vec.h"

#include <bit>
#include <cstdint>

namespace rayuela {

/// Unit roundoff of float, 2^-24.
inline constexpr float kUnitRoundoff = 0x1p-24f;

/// Bound on the relative error of n rounded operations (Higham, "Accuracy and Stability", lemma 3.1).
constexpr float gamma(int n) {
    return static_cast<float>(n) * kUnitRoundoff / (1 - static_cast<float>(n) * kUnitRoundoff);
}

/// The next float above, of x that is no infinity or NaN; past the largest comes infinity.
inline float next_up(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x + 0.0f);  // + 0.0f: no negative zero
    return std::bit_cast<float>(bits + (bits >= 0 ? 1 : -1));
}

inline float next_down(float x) {
    return -next_up(-x);
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
