#pragma once

#include "core/accel/surface_point.h"
#include "core/lights/light_block.h"
#include "core/materials/packed_bsdf.h"
#include "core/math/sampler.h"
#include "core/render/path_state.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace rayuela {

/// Paths at surfaces of one kind of PackedBsdf: what most paths of most scenes meet, so these are shaded many at once. Every
/// path comes out as the stages for one path would have it, to the last bit.
struct LobeBlock {
    static constexpr std::size_t kSize = LightBlock::kSize;
    using Row = LightBlock::Row;
    using Rows = LightBlock::Rows;
    using WordRow = std::uint32_t[kSize];

    // Given.
    std::size_t size = 0;
    WordRow state;                  ///< Which of the paths.
    const PackedBsdf* bsdf[kSize];  ///< What each is at.
    PackedBsdf varying[kSize];      ///< Room for those that are worked out where they are met.

    // Filled by the first step.
    alignas(64) LightBlock light;  ///< The samples themselves by others.
    Rows wo, p_error, ng, ns;
    WordRow key_0, key_1, reversed_index;  ///< Of the samplers.

    // Found.
    Ray shadow_ray[kSize], next_ray[kSize];
    Vec4 shadow_light[kSize];                 ///< The fourth says nothing.
    Vec4 next_throughput[kSize];              ///< The fourth is PathState::bsdf_pdf.
    Rows next_local;                          ///< The direction in the frame of the shading normal.
    std::uint64_t casts_shadow_ray, goes_on;  ///< One bit a path.
};

/// All paths of a batch, of which a block names some.
struct LobePaths {
    std::span<const PathState> states;
    std::span<const Ray> rays;  ///< One a state, as the next.
    std::span<const SurfacePoint> points;
    std::span<const Sampler> samplers;  ///< See PathState::part.
};

/// What is the same for all paths of a block.
struct LobeTask {
    PackedBsdf::Kind kind;
    SamplerKind sampler;
    std::uint32_t light_dimension, lobe_dimension, direction_dimension, roulette_dimension;
    bool samples_lights;  ///< Not for deltas.
    bool interpolates;    ///< Some shading normal is another than the geometric one.
    bool mis;
    bool black_shadow_rays;     ///< Also where they bring nothing.
    float roulette_throughput;  ///< Below it paths may be cut; 0 where not yet.
};

/// First step: fetches what the next needs of the paths, and fills what LightTable::sample wants to know.
void prepare_lobes(const LobeTask& task, const LobePaths& paths, LobeBlock& block);
/// Second step, after the light samples: fills what is found.
void scatter_lobes(const LobeTask& task, const LobePaths& paths, LobeBlock& block);

}  // namespace rayuela
