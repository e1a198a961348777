#include "core/render/path_health.h"

#include "core/materials/textures.h"
#include "core/math/float_error.h"
#include "core/render/path_tracer.h"
#include "core/render/reference_trace.h"

#include <cmath>

namespace rayuela {

namespace {

constexpr std::uint32_t kDraws = 4096;
constexpr float kCosines[] = {1, 0.7f, 0.4f, 0.15f, 0.02f};
/// Roundings in the weight of one draw; the mean of equal weights shares theirs.
constexpr int kWeightRoundings = 32;

/// The vertex that the ray of `vertices[i]` left from; null for a camera ray.
const PathRecord::Vertex* departure(std::span<const PathRecord::Vertex> vertices, std::size_t i) {
    // Parts of a split path come from the same vertex.
    for (std::size_t k = i; k-- > 0;) {
        const PathRecord::Vertex& before = vertices[k];
        if (before.bounce + 1 < vertices[i].bounce) break;
        const bool is_it = before.bounce + 1 == vertices[i].bounce && before.point.p == vertices[i].state.receiver.p;
        if (is_it) return &before;
    }
    return nullptr;
}

void count_rays(const RenderScene& scene, std::uint32_t paths, const std::atomic<bool>& cancelled, PathHealth& health) {
    const FilmSettings& film = scene.scene().film;
    const auto pixels = static_cast<std::uint64_t>(film.width) * static_cast<std::uint64_t>(film.height);
    const PathTracer tracer(scene, film.width, film.height);
    PathBatch batch;
    PathRecord record;
    for (std::uint32_t i = 0; i < paths && !cancelled; ++i) {
        // Evenly spread; a small film is gone over several times.
        const std::uint64_t place = std::uint64_t{i} * std::max<std::uint64_t>(pixels / paths, 1);
        batch.ids = {{static_cast<std::uint32_t>(place % pixels), static_cast<std::uint32_t>(place / pixels)}};
        record = {};
        if (!tracer.trace(batch, cancelled, &record)) return;
        ++health.paths;
        for (std::size_t k = 0; k < record.vertices.size(); ++k) {
            if (const PathRecord::Vertex* from = departure(record.vertices, k))
                count_ray(scene.accelerator().instances(), *from, record.vertices[k], health);
        }
    }
}

}  // namespace

void count_ray(std::span<const GeometryInstance> instances, const PathRecord::Vertex& from,
               const PathRecord::Vertex& to, PathHealth& health) {
    ++health.scattered_rays;
    const TracedShape& shape = instances[from.hit.object].shape;
    const bool is_sphere = std::holds_alternative<Sphere>(shape), is_box = std::holds_alternative<Box>(shape);
    const bool inward = glm::dot(to.ray.direction, from.point.ng) < 0;
    const bool same = to.hit.object == from.hit.object && to.hit.primitive == from.hit.primitive;
    if (same && !(is_sphere && inward)) ++health.self_hits;
    if (!inward || !(is_sphere || is_box)) return;
    ++health.inner_rays;
    const auto exit = reference_distance(TracedObject(instances[from.hit.object]), RayD(to.ray));
    if (!exit || to.hit.t > *exit * (1 + 4 * double{kUnitRoundoff})) ++health.left_closed;
}

void count_draws(const DrawDirection& draw, PathHealth& health) {
    Vec3d sum(0), squares(0);
    std::uint64_t drawn = 0;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        const Sampler sampler(SamplerKind::independent, 0, 0, i);
        const auto sample = draw(sampler.get_1d(0), sampler.get_2d(1));
        if (!sample) continue;
        const Vec3d weight(sample->weight);
        sum += weight;
        squares += weight * weight;
        ++drawn;
    }
    if (drawn == 0) return;  // black: it absorbs everything
    health.draws += kDraws;
    health.without_pdf += kDraws - drawn;
    ++health.energy_tests;
    const Vec3d mean = sum / double{kDraws};
    const Vec3d error = glm::sqrt(glm::max(squares / double{kDraws} - mean * mean, 0.0) / double{kDraws});
    const Vec3d limit = 1.0 + double{gamma(kWeightRoundings)} + 4.0 * error;
    if (!glm::all(glm::lessThanEqual(mean, limit))) ++health.above_one;
    health.highest_share = std::max(health.highest_share, max_component(Vec3(mean)));
}

PathHealth measure_path_health(const RenderScene& scene, std::uint32_t paths, const std::atomic<bool>& cancelled) {
    PathHealth health;
    for (const MaterialEntry& entry : scene.scene().materials) {
        const Bsdf bsdf = make_bsdf(with_pixels(entry.material, [](const Image&) {}), Vec2(0.5f));
        for (const float cosine : kCosines) {
            if (cancelled) return health;
            const float sine = std::sqrt(1 - cosine * cosine);
            const auto count_from = [&](const Vec3& wo) {
                count_draws([&](float u_lobe, const Vec2& u) { return bsdf.sample(wo, u_lobe, u); }, health);
            };
            count_from(Vec3(sine, 0, cosine));
            if (transmits(entry.material)) count_from(Vec3(sine, 0, -cosine));
        }
    }
    count_rays(scene, paths, cancelled, health);
    return health;
}

}  // namespace rayuela
