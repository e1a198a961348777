#pragma once

#include "core/lights/light_block.h"
#include "core/math/sampler.h"

#include <cstddef>
#include <cstdint>

namespace rayuela {

/// Paths at untextured diffuse surfaces, as a structure of arrays: what most paths of most scenes meet, so these are
/// shaded many at once. Every path comes out as the stages for one path would have it, to the last bit.
struct MatteBlock {
    static constexpr std::size_t kSize = LightBlock::kSize;
    using Row = LightBlock::Row;
    using Rows = LightBlock::Rows;
    using WordRow = std::uint32_t[kSize];

    std::size_t size = 0;
    LightBlock light;  ///< Holds the points p; the rest is filled between the steps.

    // Given.
    alignas(64) Rows wo;
    Rows p_error, ng, ns;
    Rows throughput, albedo;
    WordRow key_0, key_1, reversed_index;  ///< Of the samplers.

    // Found.
    Rows shadow_origin, shadow_direction, shadow_light;
    Rows next_origin, next_direction, next_throughput;
    Rows next_local;  ///< The direction in the frame of the shading normal.
    Row next_pdf;
    std::uint64_t casts_shadow_ray, goes_on;  ///< One bit a path.
};

/// What is the same for all paths of a block.
struct MatteTask {
    SamplerKind sampler;
    std::uint32_t light_dimension, direction_dimension, roulette_dimension;
    bool samples_lights, mis;
    bool black_shadow_rays;     ///< Also where they bring nothing.
    float roulette_throughput;  ///< Below it paths may be cut; 0 where not yet.
};

/// Fills what LightTable::sample wants to know.
void prepare_light_samples(const MatteTask& task, MatteBlock& block);
/// Fills what is found, from all the rest and the light samples.
void scatter_matte(const MatteTask& task, MatteBlock& block);

}  // namespace rayuela
