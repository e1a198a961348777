#include "core/render/interaction.h"
#include "core/render/path_dimensions.h"
#include "core/render/path_tracer.h"

#include <bit>

// The part of PathTracer that shades surfaces of packed Bsdfs, many at once.

namespace rayuela {

/// Whether this path is shaded in a LobeBlock wherever the Bsdf is packed.
bool PathTracer::in_block(const PathState& state, const PackedMaterial& material, int bounce) const {
    return material.packed && options_.shortcuts.lobe_blocks && !(material.smooth && aims(state, bounce));
}

/// `lobe` has to stay where it is until the block is shaded.
void PathTracer::add_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const {
    LobeBlock& block = batch.lobes[static_cast<std::size_t>(lobe.kind)];
    const std::size_t to = block.size++;
    block.state[to] = static_cast<std::uint32_t>(i);
    block.bsdf[to] = &lobe;
    if (block.size == LobeBlock::kSize) shade_block(batch, lobe.kind, bounce);
}

/// The same for what holds at this point only.
void PathTracer::add_copy_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const {
    LobeBlock& block = batch.lobes[static_cast<std::size_t>(lobe.kind)];
    PackedBsdf& copy = block.varying[block.size];
    copy = lobe;
    add_to_block(batch, i, copy, bounce);
}

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
    for (std::uint64_t rest = block.goes_on; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t from = block.state[i];
        const float pdf = block.next_throughput[i].w;
        PathState& state = batch.next_states.emplace_back(batch.states[from]);
        if (light_tracer_) {
            const Ray& ray = batch.rays[from];
            const Interaction at(batch.points[from], scene_.packed_material(batch.hits[from].object), -ray.direction);
            const BsdfSample sample{.wi = vec(block.next_local, i), .pdf = pdf, .specular = is_delta(kind)};
            state.light_ratio = light_ratio(state, ray, at, block.next_ray[i].direction, sample, bounce);
        }
        state.throughput = Color(block.next_throughput[i]);
        state.receiver = block.light.receiver(i);
        state.bsdf_pdf = is_delta(kind) ? 0 : pdf;
        batch.next_rays.push_back(block.next_ray[i]);
    }
    block.size = 0;
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
