#include "core/render/path_tracer.h"

#include "core/math/sampler_batch.h"
#include "core/math/sampling.h"
#include "core/render/aimed_bsdf.h"
#include "core/render/interaction.h"
#include "core/render/path_dimensions.h"

#include <algorithm>
#include <climits>
#include <numeric>

namespace rayuela {

namespace {

/// First bounce that Russian roulette may cut where the scene leaves it to the renderer.
constexpr int kDefaultRouletteStart = 2;
/// Throughput below which a path is cut with a probability that grows as it falls: the lower, the more light a cut takes
/// away. Exact radiances of the pixels to compare with (adjoint-driven roulette, Vorba & Krivanek 2016) gain nothing more.
constexpr float kRouletteThroughput = 0.4f;
/// Where light samples find only a part of the light, a cut takes direct light too and not only what is reflected again.
constexpr float kRouletteThroughputToSky = 1.0f / 8;
/// Of paths that all caustics are left to: rare and bright.
constexpr float kRouletteThroughputToCaustics = 1.0f / 16;
/// Delta lobes are spared so many bounces longer: no light sample can take the place of the path that is cut.
constexpr int kSparedSpecularBounces = 16;
/// Parts of a path that comes by way of a mirror or glass to where caustics are left to it alone: nothing else in it is as
/// noisy. On caustics seen in glass and mirror 4 take a quarter off the time to a given error; 2 and 8 less.
constexpr std::uint32_t kParts = 4;

float roulette_throughput(const RenderScene& scene, bool light_sampling) {
    const bool unsampled_sky = scene.features().environment && !scene.environment().image();
    return light_sampling && !unsampled_sky ? kRouletteThroughput : kRouletteThroughputToSky;
}

void record_arrivals(const PathBatch& batch, int bounce, PathRecord& record) {
    for (std::size_t i = 0; i < batch.rays.size(); ++i)
        record.vertices.push_back({bounce, batch.states[i], batch.rays[i], batch.hits[i], batch.points[i]});
}

void record_light(const PathBatch& batch, int bounce, PathRecord& record) {
    for (std::size_t i = 0; i < batch.shadow_rays.size(); ++i)
        record.light_samples.push_back({bounce, batch.shadow_rays[i], batch.shadow_light[i], batch.blocked[i] != 0});
    record.radiance.push_back(std::accumulate(batch.radiance.begin(), batch.radiance.end(), Color(0)));
}

void note_first_objects(PathBatch& batch) {
    for (std::size_t i = 0; i < batch.hits.size(); ++i) batch.first_object[batch.states[i].path] = batch.hits[i].object;
}

}  // namespace

PathTracer::PathTracer(const RenderScene& scene, int width, int height, const PathTracerOptions& options)
    : scene_(scene),
      width_(width),
      height_(height),
      options_(options),
      camera_(scene.camera(), static_cast<double>(scene.scene().film.width) / scene.scene().film.height),
      passing_rays_(scene.accelerator(), camera_),
      parts_seed_(static_cast<std::uint32_t>(mix_bits(scene.scene().render.seed + 0x9e3779b97f4a7c15u))),
      rr_start_(scene.scene().render.rr_start.value_or(kDefaultRouletteStart)),
      light_sampling_(options.light_sampling && scene.features().light_sampling()),
      sees_sky_(scene.features().environment || !options.shortcuts.no_sky),
      roulette_throughput_(roulette_throughput(scene, light_sampling_)) {
    if (options.light_tracing && options.light_sampling && scene.emission())
        light_tracer_.emplace(scene, camera_, width, height);
    may_aim_ = light_tracer_ && light_tracer_->lamps_are_small();
}

bool PathTracer::trace(PathBatch& batch, const std::atomic<bool>& cancelled, PathRecord* record) const {
    const bool materials_vary = scene_.features().textures || !options_.shortcuts.ready_materials;
    return materials_vary ? trace_as<true>(batch, cancelled, record) : trace_as<false>(batch, cancelled, record);
}

template <bool kVaries>
bool PathTracer::trace_as(PathBatch& batch, const std::atomic<bool>& cancelled, PathRecord* record) const {
    camera_rays(batch);
    // A record is of the rays that are traced.
    if (passing_rays_.possible() && options_.shortcuts.passing_rays && !record) end_passing_rays(batch);
    for (int bounce = 0; !batch.rays.empty(); ++bounce) {
        if (cancelled) return false;
        intersect(batch);
        surface_interactions<kVaries>(batch);
        if (record) record_arrivals(batch, bounce, *record);
        shade<kVaries>(batch, bounce);
        add_unblocked_light(batch);
        if (record) record_light(batch, bounce, *record);
    }
    add_parts(batch);
    return true;
}

void PathTracer::intersect(PathBatch& batch) const {
    batch.hits.resize(batch.rays.size());
    scene_.accelerator().intersect(batch.rays, batch.hits);
    batch.counts.rays += batch.rays.size();
}

template <bool kVaries>
void PathTracer::surface_interactions(PathBatch& batch) const {
    batch.points.resize(batch.rays.size());
    batch.with_uv.clear();
    if (kVaries) {
        for (const Hit& hit : batch.hits)
            batch.with_uv.push_back(hit.valid() && varies<kVaries>(scene_.packed_material(hit.object)) ? 1 : 0);
    }
    scene_.surfaces().points(batch.rays, batch.hits, batch.with_uv, batch.points);
}

/// Whether the Bsdf has to be worked out at the hit.
template <bool kVaries>
bool PathTracer::varies(const PackedMaterial& material) const {
    return kVaries && (material.textured || !options_.shortcuts.ready_materials);
}

/// Whether this path is shaded in a LobeBlock wherever the Bsdf is packed.
inline bool PathTracer::in_block(const PathState& state, const PackedMaterial& material, int bounce) const {
    return material.packed && options_.shortcuts.lobe_blocks && !(aims(state, bounce) && material.smooth);
}

/// `lobe` has to stay where it is until the block is shaded.
inline void PathTracer::add_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const {
    LobeBlock& block = batch.lobes[static_cast<std::size_t>(lobe.kind)];
    const std::size_t to = block.size++;
    block.state[to] = static_cast<std::uint32_t>(i);
    block.bsdf[to] = &lobe;
    if (block.size == LobeBlock::kSize) shade_block(batch, lobe.kind, bounce);
}

/// The same for what holds at this point only.
inline void PathTracer::add_copy_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const {
    LobeBlock& block = batch.lobes[static_cast<std::size_t>(lobe.kind)];
    PackedBsdf& copy = block.varying[block.size];
    copy = lobe;
    add_to_block(batch, i, copy, bounce);
}

/// Whether all caustics are left to this path: no lamp's path can be the same.
inline bool PathTracer::aims(const PathState& state, int bounce) const {
    return may_aim_ && bounce > 0 && state.light_ratio == 0;
}

template <bool kVaries>
void PathTracer::shade(PathBatch& batch, int bounce) const {
    const bool dark = options_.shortcuts.no_light && !scene_.features().any_light();
    const bool last = bounce >= scene_.scene().render.max_bounces || dark;
    batch.shadow_rays.clear();
    batch.shadow_light.clear();
    batch.shadow_parts.clear();
    batch.next_states.clear();
    batch.next_rays.clear();
    if (bounce == 0) note_first_objects(batch);
    for (std::size_t i = 0; i < batch.rays.size(); ++i) {
        const Hit& hit = batch.hits[i];
        if (!hit.valid()) {
            if (sees_sky_) leave(batch, batch.states[i], batch.rays[i].direction);
            continue;
        }
        const PackedMaterial& material = scene_.packed_material(hit.object);
        batch.counts.textured_hits += varies<kVaries>(material);
        if (in_block(batch.states[i], material, bounce)) {
            if (last) continue;
            if (!varies<kVaries>(material)) {
                add_to_block(batch, i, *material.packed, bounce);
                continue;
            }
            if (const auto lobe = packed_bsdf(material.material, batch.points[i].uv)) {
                add_copy_to_block(batch, i, *lobe, bounce);
                continue;
            }
        }
        add_surface(batch, i, material, varies<kVaries>(material));
        if (batch.surfaces.at.size() == SurfaceBlock::kSize) shade_surfaces(batch, bounce, last);
    }
    shade_surfaces(batch, bounce, last);
    for (const PackedBsdf::Kind kind : PackedBsdf::kKinds) shade_block(batch, kind, bounce);
    batch.states.swap(batch.next_states);
    batch.rays.swap(batch.next_rays);
}

/// Adds the light that the surface sends; the rest waits until many are there.
void PathTracer::add_surface(PathBatch& batch, std::size_t i, const PackedMaterial& material, bool varies) const {
    const PathState& state = batch.states[i];
    const Ray& ray = batch.rays[i];
    const Interaction& at = batch.surfaces.at.emplace_back(batch.points[i], material, -ray.direction, varies);
    if (material.emissive) batch.radiance[state.part] += emitted_light(state, ray, batch.hits[i], at);
    batch.surfaces.states.push_back(static_cast<std::uint32_t>(i));
}

/// Shades what has gathered, and empties the block.
void PathTracer::shade_surfaces(PathBatch& batch, int bounce, bool last) const {
    SurfaceBlock& block = batch.surfaces;
    if (!last) draw_numbers(batch, bounce);
    for (std::size_t k = 0; k < block.at.size(); ++k) {
        const Interaction& at = block.at[k];
        const std::size_t i = block.states[k];
        const PathState& state = batch.states[i];
        const Ray& ray = batch.rays[i];
        if (last) continue;
        const AimedBsdf bsdf(at, aims(state, bounce) ? &scene_.emission()->targets() : nullptr);
        if (light_sampling_ && at.material.smooth && block.light.pdf[k] > 0)
            add_light(batch, state, at, bsdf, block.light.sample(k));
        if (bsdf.aims() && state.bsdf_pdf == 0 && state.part == state.path) {
            split(batch, state, ray, at, bsdf, bounce);
        } else {
            scatter(batch, state, ray, at, bsdf, {block.lobe_numbers[k], block.direction_numbers[k]}, bounce);
        }
    }
    block.at.clear();
    block.states.clear();
}

/// Draws what the surfaces of the block need: light samples, and the numbers to scatter with.
void PathTracer::draw_numbers(PathBatch& batch, int bounce) const {
    SurfaceBlock& block = batch.surfaces;
    const std::size_t n = block.at.size();
    block.samplers.clear();
    for (const std::uint32_t i : block.states) block.samplers.push_back(batch.samplers[batch.states[i].part]);
    draw_1d(block.samplers, dimension(bounce, kLobe), block.lobe_numbers);
    draw_2d(block.samplers, direction_dimension(bounce, light_sampling_), block.direction_numbers);
    if (!light_sampling_) return;
    draw_2d(block.samplers, light_dimension(bounce), block.light_numbers);
    block.light.size = n;
    for (std::size_t k = 0; k < n; ++k) {
        block.light.put_receiver(k, block.at[k].receiver());
        block.light.u[k] = block.light_numbers[k].x;
        block.light.v[k] = block.light_numbers[k].y;
    }
    scene_.lights().sample(block.light, options_.shortcuts.lamp_blocks);
}

/// Goes on as several paths of equal weight.
void PathTracer::split(PathBatch& batch, const PathState& state, const Ray& ray, const Interaction& at,
                       const AimedBsdf& bsdf, int bounce) const {
    const RenderSettings& settings = scene_.scene().render;
    const auto [pixel, sample] = batch.ids[state.path];
    PathState part = state;
    part.throughput /= static_cast<float>(kParts);
    for (std::uint32_t i = 0; i < kParts; ++i) {
        part.part = static_cast<std::uint32_t>(batch.samplers.size());
        batch.part_paths.push_back(state.path);
        batch.radiance.emplace_back(0);
        const Sampler& sampler = batch.samplers.emplace_back(settings.sampler, parts_seed_, pixel, sample * kParts + i);
        const ScatterNumbers numbers{sampler.get_1d(dimension(bounce, kLobe)),
                                     sampler.get_2d(direction_dimension(bounce, light_sampling_))};
        scatter(batch, part, ray, at, bsdf, numbers, bounce);
    }
}

/// Adds what comes from the environment.
void PathTracer::leave(PathBatch& batch, const PathState& state, const Vec3& direction) const {
    ++batch.counts.environment_lookups;
    batch.radiance[state.part] += environment_light(state, direction);
}

Color PathTracer::environment_light(const PathState& state, const Vec3& direction) const {
    const float light_pdf = light_sampling_ && state.bsdf_pdf > 0 ? scene_.lights().environment_pdf(direction) : 0;
    return state.throughput * scene_.environment().radiance(direction) * scattering_weight(state.bsdf_pdf, light_pdf);
}

Color PathTracer::emitted_light(const PathState& state, const Ray& ray, const Hit& hit, const Interaction& at) const {
    const Color radiance = emitted(at.material.material, at.point.uv, at.front());
    if (is_black(radiance)) return Color(0);
    if (state.bsdf_pdf == 0) {
        const float weight = light_tracer_ ? light_tracer_->camera_weight(state.light_ratio, hit, at) : 1;
        return state.throughput * radiance * weight;
    }
    const float light_pdf =
        light_sampling_ ? scene_.lights().pdf(state.receiver, ray.direction, hit, at.point.p, at.point.ng) : 0;
    return state.throughput * radiance * scattering_weight(state.bsdf_pdf, light_pdf);
}

/// Share of scattering in finding light that light sampling would have found with density `light_pdf`; all of it after a
/// camera or a delta lobe (bsdf_pdf 0).
float PathTracer::scattering_weight(float bsdf_pdf, float light_pdf) const {
    if (bsdf_pdf == 0 || light_pdf == 0) return 1;
    return options_.mis ? power_heuristic(bsdf_pdf, light_pdf) : 0;
}

/// Adds a light sample, to count where nothing is in its way.
void PathTracer::add_light(PathBatch& batch, const PathState& state, const Interaction& at, const AimedBsdf& bsdf,
                           const LightSample& light) const {
    const Vec3 wi = at.frame.to_local(light.wi);
    Color arriving(0);
    if (at.consistent(light.wi, wi)) {
        const BsdfValue f = bsdf.evaluate(wi, light.wi);
        const float weight = options_.mis ? power_heuristic(light.pdf, f.pdf) : 1;
        arriving = state.throughput * f.value * light.radiance * (weight / light.pdf);
    }
    if (is_black(arriving) && options_.shortcuts.black_shadow_rays) return;
    batch.shadow_rays.push_back(shadow_ray(at.ray_origin(light.wi), light));
    batch.shadow_light.push_back(arriving);
    batch.shadow_parts.push_back(state.part);
}

/// Sends the path on its way, or ends it.
void PathTracer::scatter(PathBatch& batch, const PathState& state, const Ray& ray, const Interaction& at,
                         const AimedBsdf& bsdf, const ScatterNumbers& numbers, int bounce) const {
    const auto sample = bsdf.sample(numbers.lobe, numbers.direction);
    if (!sample) return;
    const Vec3 wi = at.frame.to_world(sample->wi);
    if (!at.consistent(wi, sample->wi)) return;
    Color throughput = state.throughput * sample->weight;
    const float reach = max_component(throughput);
    if (!(reach > 0)) return;
    // Delta lobes are spared by bounces instead.
    const float limit = aims(state, bounce) && !sample->specular ? kRouletteThroughputToCaustics : roulette_throughput_;
    if (bounce + 1 >= roulette_start(sample->specular) && reach < limit) {
        const float survival = reach / limit;
        if (batch.samplers[state.part].get_1d(dimension(bounce, kRoulette)) >= survival) return;
        throughput /= survival;
    }
    // Member by member: a whole that is copied has to wait for its parts to be stored.
    PathState& next = batch.next_states.emplace_back(state);
    next.throughput = throughput;
    if (light_tracer_) next.light_ratio = light_ratio(state, ray, at, wi, *sample, bounce);
    next.receiver.p = at.point.p;
    next.receiver.n = at.receiver_normal();
    next.bsdf_pdf = sample->specular ? 0 : sample->pdf;
    Ray& next_ray = batch.next_rays.emplace_back();
    next_ray.origin = at.ray_origin(wi);
    next_ray.direction = wi;
}

/// PathState::light_ratio after scattering.
float PathTracer::light_ratio(const PathState& state, const Ray& ray, const Interaction& at, const Vec3& wi,
                              const BsdfSample& sample, int bounce) const {
    if (bounce > 0) {
        if (sample.specular) return at.same_frame(wi) ? state.light_ratio : 0;
        return LightTracer::scattered_ratio(state.light_ratio, at, wi, sample.wi, sample.pdf);
    }
    if (sample.specular || !at.same_frame(wi)) return 0;
    const float distance = glm::length(at.point.p - ray.origin);
    return at.cosine(wi) / (sample.pdf * light_tracer_->camera_density(at, ray.direction, distance));
}

/// First bounce that roulette may cut.
int PathTracer::roulette_start(bool specular) const {
    if (!options_.russian_roulette) return INT_MAX;
    return rr_start_ + (specular ? kSparedSpecularBounces : 0);
}

void PathTracer::add_unblocked_light(PathBatch& batch) const {
    const std::size_t n = batch.shadow_rays.size();
    if (n == 0) return;
    batch.blocked.resize(n);
    if (options_.shortcuts.any_hit) {
        scene_.accelerator().occluded(batch.shadow_rays, batch.blocked);
    } else {
        batch.hits.resize(n);
        scene_.accelerator().intersect(batch.shadow_rays, batch.hits);
        std::ranges::transform(batch.hits, batch.blocked.begin(), [](const Hit& hit) { return hit.valid() ? 1 : 0; });
    }
    batch.counts.shadow_rays += n;
    for (std::size_t i = 0; i < n; ++i) {
        if (!batch.blocked[i]) batch.radiance[batch.shadow_parts[i]] += batch.shadow_light[i];
    }
}

/// Each part has a sum of its own, and these are added at the end: whatever paths are traced beside it, a path's light is added
/// up in the same order.
void PathTracer::add_parts(PathBatch& batch) const {
    const std::size_t n = batch.ids.size();
    for (std::size_t i = 0; i < batch.part_paths.size(); ++i)
        batch.radiance[batch.part_paths[i]] += batch.radiance[n + i];
    batch.radiance.resize(n);
}

Color trace_one(const RenderScene& scene, const PathId& id, const PathTracerOptions& options, PathRecord* record) {
    const FilmSettings& film = scene.scene().film;
    PathBatch batch;
    batch.ids = {id};
    PathTracer(scene, film.width, film.height, options).trace(batch, std::atomic<bool>(false), record);
    return batch.radiance[0];
}

}  // namespace rayuela
