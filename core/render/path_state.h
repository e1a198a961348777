#pragma once

#include "core/lights/light_importance.h"
#include "core/math/vec.h"

#include <cstdint>

namespace rayuela {

/// What a path carries from one bounce to the next.
struct PathState {
    Color throughput{1};
    std::uint32_t path = 0;  ///< Which of the batch.
    std::uint32_t part = 0;  ///< Which sampler and which sum of the batch: the path's own unless it has been split.
    LightReceiver receiver;  ///< At the last scattering, not offset.
    float light_ratio = 0;   ///< See LightTracer; 0 where no path from a lamp could be the same.
    float bsdf_pdf = 0;  ///< Density with which the last scattering chose the direction; 0 for camera and delta lobes.
};

}  // namespace rayuela
