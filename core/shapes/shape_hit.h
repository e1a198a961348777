#pragma once

#include "core/math/ray.h"

#include <cmath>

namespace rayuela {

/// What the intersection of a ray with one shape gives. t is rounded to float once, before it is compared with anything:
/// so a ray whose t_max is the t of a hit still has that hit.
struct ShapeHit {
    float t = kInfinity;
    float u = 0, v = 0;
    std::uint32_t primitive = 0;
    float t_rest = 0;  ///< See Hit.
};

/// The hit at t, and before the rounding of t what it leaves out.
inline ShapeHit triangle_hit(double t, double u, double v) {
    const auto rounded = static_cast<float>(t);
    return {.t = rounded,
            .u = static_cast<float>(u),
            .v = static_cast<float>(v),
            .t_rest = static_cast<float>(t - double{rounded})};
}

/// The closed interval of t in which a hit counts. Comparisons are false on NaN.
struct TRange {
    float min = 0;
    float max = kInfinity;

    bool contains(float t) const { return t >= min && t <= max && std::fabs(t) < kInfinity; }
};

}  // namespace rayuela
