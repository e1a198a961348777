#pragma once

#include "core/math/ray.h"

namespace rayuela {

/// A direction drawn towards a light, seen from a point p.
struct LightSample {
    Vec3 wi{0};                  ///< Unit, from p towards the light.
    float distance = kInfinity;  ///< From p to the light; infinite for an environment.
    Vec3 target{0};     ///< Just in front of the light's surface: a shadow ray ends here. Unused when infinite.
    Color radiance{0};  ///< That arrives at p where nothing is in between.
    float pdf = 0;      ///< Per solid angle at p, the choice of the light included. Positive.
};

/// The ray that is blocked by what stands between a point and a light. `origin` is p moved off its own surface; the
/// light's surface lies beyond the end by more than rounding, so that it never shadows itself.
inline Ray shadow_ray(const Vec3& origin, const LightSample& sample) {
    if (sample.distance == kInfinity) return {origin, 0, sample.wi, kInfinity};
    return {origin, 0, sample.target - origin, 1};
}

}  // namespace rayuela
