#pragma once

#include "core/lights/light_block.h"
#include "core/materials/single_lobe.h"
#include "core/math/sampler.h"

#include <cstddef>
#include <cstdint>

namespace rayuela {

/// Paths at surfaces of single lobes of one kind, as a structure of arrays: what most paths of most scenes meet, so these
/// are shaded many at once. Every path comes out as the stages for one path would have it, to the last bit.
struct LobeBlock {
    static constexpr std::size_t kSize = LightBlock::kSize;
    using Row = LightBlock::Row;
    using Rows = LightBlock::Rows;
    using WordRow = std::uint32_t[kSize];

    std::size_t size = 0;
    LightBlock light;  ///< Holds the points p; the rest is filled between the steps.

    // Given.
    alignas(64) Rows wo;
    Rows p_error, ng, ns;
    Rows throughput, color;  ///< The latter and `shape` as in SingleLobe.
    Row shape;
    WordRow key_0, key_1, reversed_index;  ///< Of the samplers.
    WordRow state;                         ///< For the caller: which path.

    // Found.
    Rows shadow_origin, shadow_direction, shadow_light;
    Rows next_origin, next_direction, next_throughput;
    Rows next_local;                          ///< The direction in the frame of the shading normal.
    Row next_pdf;                             ///< As BsdfSample has it.
    std::uint64_t casts_shadow_ray, goes_on;  ///< One bit a path.
};

/// What is the same for all paths of a block.
struct LobeTask {
    SingleLobe::Kind kind;
    SamplerKind sampler;
    std::uint32_t light_dimension, lobe_dimension, direction_dimension, roulette_dimension;
    bool samples_lights;  ///< Not for deltas.
    bool mis;
    bool black_shadow_rays;     ///< Also where they bring nothing.
    float roulette_throughput;  ///< Below it paths may be cut; 0 where not yet.
};

/// Fills what LightTable::sample wants to know.
void prepare_light_samples(const LobeTask& task, LobeBlock& block);
/// Fills what is found, from all the rest and the light samples.
void scatter_lobes(const LobeTask& task, LobeBlock& block);

}  // namespace rayuela
