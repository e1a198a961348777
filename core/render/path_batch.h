#pragma once

#include "core/accel/surface_point.h"
#include "core/math/sampler.h"
#include "core/render/interaction.h"
#include "core/render/lobe_block.h"
#include "core/render/path_state.h"

#include <array>
#include <cstdint>
#include <iterator>
#include <vector>

namespace rayuela {

/// Names one camera path of a film: everything random about it follows from this and the scene's seed.
struct PathId {
    std::uint32_t pixel = 0;  ///< Row-major, from the upper left.
    std::uint32_t sample = 0;
};

struct RayCounts {
    std::uint64_t paths = 0, rays = 0, shadow_rays = 0;
    std::uint64_t lamp_paths = 0;           ///< See LightTracer.
    std::uint64_t environment_lookups = 0;  ///< By rays that have left the scene.
    std::uint64_t textured_hits = 0;        ///< At which a material had to be worked out anew.
    std::uint64_t passing_rays = 0;  ///< Of the rays, those of the camera that have not been traced: see PassingRays.

    RayCounts& operator+=(const RayCounts& other) {
        paths += other.paths;
        rays += other.rays;
        shadow_rays += other.shadow_rays;
        lamp_paths += other.lamp_paths;
        environment_lookups += other.environment_lookups;
        textured_hits += other.textured_hits;
        passing_rays += other.passing_rays;
        return *this;
    }
};

/// Paths at all other surfaces: shaded one by one, but their random numbers and light samples are drawn together.
struct SurfaceBlock {
    static constexpr std::size_t kSize = LightBlock::kSize;

    std::vector<Interaction> at;
    std::vector<std::uint32_t> states;  ///< Which of PathBatch::states.
    std::vector<Sampler> samplers;
    float lobe_numbers[kSize];
    Vec2 direction_numbers[kSize], light_numbers[kSize];
    LightBlock light{};
};

/// Many paths on their way, as a structure of arrays, and the scratch memory of the stages that drive them. Kept by a
/// worker from batch to batch: after the first nothing is allocated.
struct PathBatch {
    // One a path.
    std::vector<PathId> ids;
    std::vector<Color> radiance;              ///< The result; on the way followed by those of the parts of split paths.
    std::vector<std::uint32_t> first_object;  ///< Hit::object of the camera ray.

    std::vector<Vec2> positions;            ///< Of the image.
    std::vector<std::uint8_t> passes;       ///< Whether the camera ray passes all objects by.
    std::vector<Vec2> lens;                 ///< Points of the unit disc; empty where the lens has no extent.
    std::vector<Sampler> samplers;          ///< One a path, then those of the parts of split paths.
    std::vector<std::uint32_t> part_paths;  ///< Which path each of these parts belongs to.

    // One a path still on its way, in the order of the paths.
    std::vector<PathState> states, next_states;
    std::vector<Ray> rays, next_rays;
    std::vector<Hit> hits;
    std::vector<SurfacePoint> points;
    std::vector<std::uint8_t> with_uv;  ///< Whether texture coordinates are asked for; empty where they never are.

    // One a shadow ray.
    std::vector<Ray> shadow_rays;
    std::vector<Color> shadow_light;  ///< What arrives when nothing is in the way.
    std::vector<std::uint32_t> shadow_parts;
    std::vector<std::uint8_t> blocked;

    std::array<LobeBlock, std::size(PackedBsdf::kKinds)> lobes{};  ///< One a kind; their states are of `states`.
    SurfaceBlock surfaces;

    RayCounts counts;  ///< Of all batches since the worker set them to 0.
};

}  // namespace rayuela
