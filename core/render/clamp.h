#pragma once

#include "core/math/vec.h"

#include <algorithm>

namespace rayuela {

/// `radiance`, darkened in proportion so that no channel exceeds `limit` > 0. What is not finite stays as it is.
inline Color clamped(const Color& radiance, float limit) {
    const float brightest = std::max({radiance.x, radiance.y, radiance.z});
    return brightest > limit && brightest < INFINITY ? radiance * (limit / brightest) : radiance;
}

}  // namespace rayuela
