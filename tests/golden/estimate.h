#pragma once

#include "core/math/image.h"
#include "core/render/path_tracer.h"
#include "core/scene/scene.h"

#include <cmath>

namespace rayuela {

/// An image with its uncertainty, from renders with independent seeds.
struct Estimate {
    Image mean;
    Image error;  ///< Standard error of the mean, per pixel and channel.
};

struct EstimateSettings {
    std::uint32_t first_seed = 0;
    int seeds = 64;
    int spp = 2;  ///< Of each seed.
    PathTracerOptions options;
};

/// Renders scene.film's size.
Estimate estimate(const Scene& scene, const EstimateSettings& settings);

/// How far two estimates of the same image lie apart, in standard errors, per block of pixels and channel.
struct Comparison {
    Image score;      ///< One pixel a block, signed.
    float worst = 0;  ///< Largest magnitude in `score`.
    Vec3 whole{0};    ///< Of the mean over the whole image.
};
Comparison compare(const Estimate& a, const Estimate& b, int block);

}  // namespace rayuela
