#include "core/render/interaction.h"
#include "core/render/path_dimensions.h"
#include "core/render/path_tracer.h"

#include <bit>

// The part of PathTracer that shades surfaces of packed Bsdfs, many at once.

namespace rayuela {

/// Shades what has gathered, and empties the block.
void PathTracer::shade_block(PathBatch& batch, PackedBsdf::Kind kind, int bounce) const {
    LobeBlock& block = batch.lobes[static_cast<std::size_t>(kind)];
    if (block.size == 0) return;
    const LobeTask task = lobe_task(kind, bounce);
    const LobePaths paths{batch.states, batch.rays, batch.points, batch.samplers};
    prepare_lobes(task, paths, block);
    if (task.samples_lights) scene_.lights().sample(block.light, options_.shortcuts.lamp_blocks);
    scatter_lobes(task, paths, block);
    for (std::uint64_t rest = block.casts_shadow_ray; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        batch.shadow_rays.push_back(block.shadow_ray[i]);
        batch.shadow_light.emplace_back(block.shadow_light[i]);
        batch.shadow_parts.push_back(batch.states[block.state[i]].part);
    }
    const std::size_t first = batch.next_states.size();
    for (std::uint64_t rest = block.goes_on; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        PathState& state = batch.next_states.emplace_back(batch.states[block.state[i]]);
        state.throughput = Color(block.next_throughput[i]);
        state.receiver = block.light.receiver(i);
        state.bsdf_pdf = block.next_throughput[i].w;
        batch.next_rays.push_back(block.next_ray[i]);
    }
    if (light_tracer_) find_light_ratios(batch, block, kind, bounce, first);
    block.size = 0;
}

/// PathState::light_ratio of those that go on from the block, the next states from number `to` on.
void PathTracer::find_light_ratios(PathBatch& batch, const LobeBlock& block, PackedBsdf::Kind kind, int bounce,
                                   std::size_t to) const {
    for (std::uint64_t rest = block.goes_on; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t from = block.state[i];
        const Ray& ray = batch.rays[from];
        const Interaction at(batch.points[from], scene_.packed_material(batch.hits[from].object), -ray.direction);
        PathState& state = batch.next_states[to++];
        const BsdfSample sample{.wi = vec(block.next_local, i), .pdf = state.bsdf_pdf, .specular = is_delta(kind)};
        state.light_ratio = light_ratio(state, ray, at, block.next_ray[i].direction, sample, bounce);
    }
}

LobeTask PathTracer::lobe_task(PackedBsdf::Kind kind, int bounce) const {
    const bool roulette = bounce + 1 >= roulette_start(is_delta(kind));
    return {.kind = kind,
            .sampler = scene_.scene().render.sampler,
            .light_dimension = light_dimension(bounce),
            .lobe_dimension = dimension(bounce, kLobe),
            .direction_dimension = direction_dimension(bounce, light_sampling_),
            .roulette_dimension = dimension(bounce, kRoulette),
            .samples_lights = light_sampling_ && !is_delta(kind),
            .interpolates = scene_.surfaces().interpolate(),
            .mis = options_.mis,
            .black_shadow_rays = !options_.shortcuts.black_shadow_rays,
            .roulette_throughput = roulette ? roulette_throughput_ : 0};
}

}  // namespace rayuela
