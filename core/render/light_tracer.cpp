#include "core/render/light_tracer.h"

#include "core/math/sampler_batch.h"
#include "core/math/sampling.h"
#include "core/render/interaction.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// What a dimension of the sampler decides, as numbers within a set that is stratified together, the first two best. Set 0
/// is the lamp's and set d + 1 that of the hit at depth d.
enum LampDimension : std::uint32_t { kLampDirection, kPoint, kLamp, kTarget };
enum HitDimension : std::uint32_t { kDirection, kLens, kLobe, kRoulette };

std::uint32_t dimension(int depth, HitDimension purpose) {
    return (static_cast<std::uint32_t>(depth) + 1) * kSobolPairs + purpose;
}

/// Lamps that fill less of the directions around mirrors and glass are small. In a room with one lamp above a glass and a
/// mirror ball, what is done for small lamps halves the time to a given error at a share of 1/220, gains a little at 1/27
/// and loses a little at 1/12.
constexpr float kSmallLampShare = 1.0f / 20;
/// For small lamps, and for others. Fewer leave more noise in caustics, more take time from all else; around these values
/// the sum hardly changes.
constexpr float kPathsPerPixel = 1.0f / 4, kPathsPerPixelOfLargeLamps = 1.0f / 16;
/// Paths of a round that are stratified together, and with those of other rounds.
constexpr std::uint32_t kGroup = 4096;
/// Keeps lamp paths apart from pixels, of which there are fewer.
constexpr std::uint32_t kFirstGroup = 0x80000000u;

bool are_small(const LightEmission& emission) {
    return emission.lamp_share() < kSmallLampShare;
}

}  // namespace

LightTracer::LightTracer(const RenderScene& scene, const CameraRays& camera, int width, int height)
    : scene_(scene),
      camera_(camera),
      width_(width),
      height_(height),
      small_lamps_(are_small(*scene.emission())),
      paths_(static_cast<std::uint32_t>(std::ceil((small_lamps_ ? kPathsPerPixel : kPathsPerPixelOfLargeLamps) *
                                                  static_cast<float>(width) * static_cast<float>(height)))),
      pixels_(static_cast<float>(width) * static_cast<float>(height)) {}

bool LightTracer::shares_alike(const RenderScene& a, const RenderScene& b) {
    if (!a.emission() || !b.emission()) return a.emission() == b.emission();
    return are_small(*a.emission()) == are_small(*b.emission()) && a.emission()->draws_like(*b.emission());
}

float LightTracer::camera_density(const Interaction& at, const Vec3& ray_direction, float distance) const {
    return pixels_ * camera_.density(ray_direction) * at.cosine(ray_direction) / (distance * distance);
}

float LightTracer::scattered_ratio(float ratio, const Interaction& at, const Vec3& wi, const Vec3& wi_local,
                                   float pdf) {
    if (ratio == 0 || !at.same_frame(wi)) return 0;
    const float reverse = at.bsdf().evaluate(wi_local, at.wo_local).pdf;
    return ratio * (at.cosine(wi) * reverse) / (at.cosine(at.wo) * pdf);
}

float LightTracer::camera_weight(float ratio, const Hit& hit, const Interaction& at) const {
    if (ratio == 0) return 1;
    const float emission = scene_.emission()->pdf(hit, at.point.p, at.point.ng, at.wo);
    return 1 / (1 + static_cast<float>(paths_) * emission * ratio / at.cosine(at.wo));
}

bool LightTracer::trace(std::uint32_t first, std::uint32_t count, std::uint32_t round, LightBatch& batch,
                        const std::atomic<bool>& cancelled) const {
    batch.splats.clear();
    emit(first, count, round, batch);
    for (int depth = 0; !batch.rays.empty(); ++depth) {
        if (cancelled) return false;
        batch.hits.resize(batch.rays.size());
        scene_.accelerator().intersect(batch.rays, batch.hits);
        batch.counts.rays += batch.rays.size();
        surface_points(batch);
        draw_numbers(batch, depth);
        shade(batch, depth);
        splat_unblocked(batch);
    }
    return true;
}

void LightTracer::emit(std::uint32_t first, std::uint32_t count, std::uint32_t round, LightBatch& batch) const {
    const RenderSettings& settings = scene_.scene().render;
    batch.counts.lamp_paths += count;
    batch.samplers.resize(count);
    batch.states.clear();
    batch.rays.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t path = first + i;
        batch.samplers[i] =
            Sampler(settings.sampler, settings.seed, kFirstGroup + path / kGroup, round * kGroup + path % kGroup);
    }
    batch.lamp_numbers.resize(count);
    batch.target_numbers.resize(count);
    batch.point_numbers.resize(count);
    batch.direction_numbers.resize(count);
    draw_1d(batch.samplers, kLamp, batch.lamp_numbers);
    draw_1d(batch.samplers, kTarget, batch.target_numbers);
    draw_2d(batch.samplers, kPoint, batch.point_numbers);
    draw_2d(batch.samplers, kLampDirection, batch.direction_numbers);
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto emitted = scene_.emission()->sample(batch.lamp_numbers[i], batch.point_numbers[i],
                                                       batch.target_numbers[i], batch.direction_numbers[i]);
        if (!emitted) continue;
        const float ratio = static_cast<float>(paths_) * emitted->pdf / emitted->cosine;
        batch.states.push_back({emitted->power, ratio, max_component(emitted->power), i});
        batch.rays.push_back(emitted->ray);
    }
}

void LightTracer::surface_points(LightBatch& batch) const {
    batch.points.resize(batch.rays.size());
    batch.with_uv.clear();
    if (scene_.features().textures) {
        for (const Hit& hit : batch.hits)
            batch.with_uv.push_back(hit.valid() && scene_.packed_material(hit.object).textured ? 1 : 0);
    }
    scene_.surfaces().points(batch.rays, batch.hits, batch.with_uv, batch.points);
}

void LightTracer::draw_numbers(LightBatch& batch, int depth) const {
    batch.drawing.clear();
    for (const LightBatch::State& state : batch.states) batch.drawing.push_back(batch.samplers[state.path]);
    batch.lobe_numbers.resize(batch.drawing.size());
    batch.direction_numbers.resize(batch.drawing.size());
    draw_1d(batch.drawing, dimension(depth, kLobe), batch.lobe_numbers);
    draw_2d(batch.drawing, dimension(depth, kDirection), batch.direction_numbers);
}

void LightTracer::shade(LightBatch& batch, int depth) const {
    batch.shadow_rays.clear();
    batch.connections.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch.rays.size(); ++i) {
        const Hit& hit = batch.hits[i];
        if (!hit.valid()) continue;
        LightBatch::State& state = batch.states[kept] = batch.states[i];
        Ray& ray = batch.rays[kept] = batch.rays[i];
        const Interaction at(batch.points[i], scene_.packed_material(hit.object), -ray.direction);
        if (depth > 0 && at.material.smooth) connect(batch, state, at, depth);
        if (depth + 1 < scene_.scene().render.max_bounces &&
            scatter(batch, state, ray, at, {batch.lobe_numbers[i], batch.direction_numbers[i]}, depth)) {
            ++kept;
        }
    }
    batch.states.resize(kept);
    batch.rays.resize(kept);
}

void LightTracer::connect(LightBatch& batch, const LightBatch::State& state, const Interaction& at, int depth) const {
    const Vec2 u = scene_.features().lens ? batch.samplers[state.path].get_2d(dimension(depth, kLens)) : Vec2(0.5f);
    const auto view = camera_.view(at.point.p, sample_concentric_disk(u));
    if (!view) return;
    const Vec2 position = view->position * Vec2(static_cast<float>(width_), static_cast<float>(height_));
    const float margin = filter_radius(scene_.scene().film.filter);
    if (!(position.x > -margin && position.x < static_cast<float>(width_) + margin && position.y > -margin &&
          position.y < static_cast<float>(height_) + margin)) {
        return;
    }
    const Vec3 to_camera = view->origin - at.point.p;
    const float distance = glm::length(to_camera);
    const Vec3 w = to_camera / distance, w_local = at.frame.to_local(w);
    if (!at.consistent(w, w_local) || !at.same_frame(w)) return;
    const BsdfValue f = at.bsdf().evaluate(w_local, at.wo_local);
    const float density = camera_density(at, -w, distance), cos_lamp = at.cosine(at.wo);
    // Of the camera's density over the lamp's.
    const float inverse_ratio = f.pdf * density / (state.ratio * cos_lamp);
    const Color radiance =
        state.power * f.value * (density / (cos_lamp * static_cast<float>(paths_) * (1 + inverse_ratio)));
    if (is_black(radiance)) return;
    const Vec3 origin = at.ray_origin(w);
    batch.shadow_rays.push_back({origin, 0, view->origin - origin, 1});
    batch.connections.push_back({position, radiance});
}

/// Sends the path on its way; false where it ends.
bool LightTracer::scatter(const LightBatch& batch, LightBatch::State& state, Ray& ray, const Interaction& at,
                          const ScatterNumbers& numbers, int depth) const {
    const auto sample = at.bsdf().sample(at.wo_local, numbers.lobe, numbers.direction);
    if (!sample || (depth == 0 && !sample->specular)) return false;
    const Vec3 wi = at.frame.to_world(sample->wi);
    if (!at.consistent(wi, sample->wi) || !at.same_frame(wi)) return false;
    const float cos_ratio = at.cosine(wi) / at.cosine(at.wo);
    if (sample->specular) {
        // Interpolated normals bend what a beam holds (Veach 1997, 5.3), and so do media what is measured as L / n^2.
        state.power *=
            sample->weight * (cos_ratio * std::abs(at.wo_local.z / sample->wi.z) / (sample->eta * sample->eta));
    } else {
        const BsdfValue f = at.bsdf().evaluate(sample->wi, at.wo_local);
        state.power *= f.value * (cos_ratio / sample->pdf);
        state.ratio *= sample->pdf / (f.pdf * cos_ratio);
    }
    const float reach = max_component(state.power) / state.reach;
    if (!(reach > 0 && state.ratio > 0 && state.ratio < kInfinity)) return false;
    if (!sample->specular && reach < 1) {
        if (batch.samplers[state.path].get_1d(dimension(depth, kRoulette)) >= reach) return false;
        state.power /= reach;
    }
    ray.origin = at.ray_origin(wi);
    ray.direction = wi;
    ray.t_min = 0;
    ray.t_max = kInfinity;
    return true;
}

void LightTracer::splat_unblocked(LightBatch& batch) const {
    const std::size_t n = batch.shadow_rays.size();
    if (n == 0) return;
    batch.blocked.resize(n);
    scene_.accelerator().occluded(batch.shadow_rays, batch.blocked);
    batch.counts.shadow_rays += n;
    const PixelFilter filter = scene_.scene().film.filter;
    const float radius = filter_radius(filter);
    for (std::size_t i = 0; i < n; ++i) {
        if (batch.blocked[i]) continue;
        const auto& [position, radiance] = batch.connections[i];
        // Pixels whose centre lies within the filter's radius.
        const glm::ivec2 from = glm::max(glm::ivec2(glm::ceil(position - radius - 0.5f)), glm::ivec2(0));
        const glm::ivec2 to =
            glm::min(glm::ivec2(glm::floor(position + radius - 0.5f)), glm::ivec2(width_, height_) - 1);
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const float weight = filter_density(filter, position - (Vec2(glm::ivec2(x, y)) + 0.5f));
                if (weight > 0) batch.splats.push_back({static_cast<std::uint32_t>(y * width_ + x), weight * radiance});
            }
        }
    }
}

}  // namespace rayuela
