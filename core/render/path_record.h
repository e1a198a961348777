#pragma once

#include "core/render/path_batch.h"

#include <vector>

namespace rayuela {

/// What a path did, bounce by bounce, for a person who asks why a pixel has its value. Read off the batch between the stages.
struct PathRecord {
    /// A ray on its way and what it met (nothing: an invalid hit). `state` is that of its departure: throughput, the density
    /// with which scattering chose the direction (0: a camera or a delta lobe).
    struct Vertex {
        int bounce = 0;
        PathState state;
        Ray ray;
        Hit hit;
        SurfacePoint point;
    };
    /// A ray towards a lamp and the light that it brings where it is free, weighed against scattering.
    struct LightSample {
        int bounce = 0;
        Ray ray;
        Color light{0};
        bool blocked = false;
    };
    std::vector<Vertex> vertices;
    std::vector<LightSample> light_samples;
    std::vector<Color> radiance;  ///< Found up to and with each bounce.
};

}  // namespace rayuela
