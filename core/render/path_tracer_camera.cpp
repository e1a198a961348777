#include "core/math/sampler_batch.h"
#include "core/render/path_dimensions.h"
#include "core/render/path_tracer.h"

// The part of PathTracer that sends paths from the camera.

namespace rayuela {

void PathTracer::camera_rays(PathBatch& batch) const {
    const std::size_t n = batch.ids.size();
    const RenderSettings& settings = scene_.scene().render;
    const PixelFilter filter = scene_.scene().film.filter;
    const Vec2 pixel_size(1 / static_cast<float>(width_), 1 / static_cast<float>(height_));
    batch.samplers.resize(n);
    batch.part_paths.clear();
    batch.states.clear();
    batch.states.resize(n);
    batch.rays.resize(n);
    batch.radiance.assign(n, Color(0));
    batch.first_object.assign(n, kNone);
    batch.positions.resize(n);
    const auto begins_pixel = [&](std::size_t i) { return i == 0 || batch.ids[i].pixel != batch.ids[i - 1].pixel; };
    std::uint64_t key = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (begins_pixel(i)) key = pixel_key(settings.seed, batch.ids[i].pixel);
        batch.samplers[i] = Sampler(settings.sampler, key, batch.ids[i].sample);
    }
    draw_2d(batch.samplers, kFilter, batch.positions);
    const auto width = static_cast<std::uint32_t>(width_);
    Vec2 centre(0);
    for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t pixel = batch.ids[i].pixel;
        if (begins_pixel(i)) centre = Vec2(glm::uvec2(pixel % width, pixel / width)) + 0.5f;
        batch.positions[i] = (centre + sample_filter(filter, batch.positions[i])) * pixel_size;
        batch.states[i].path = batch.states[i].part = static_cast<std::uint32_t>(i);
    }
    draw_lens(batch);
    camera_.rays(batch.positions, batch.lens, batch.rays);
    batch.counts.paths += n;
}

/// Draws points on the lens, where it has extent.
void PathTracer::draw_lens(PathBatch& batch) const {
    batch.lens.clear();
    if (!scene_.features().lens && options_.shortcuts.no_lens) return;
    batch.lens.resize(batch.samplers.size());
    draw_disk(batch.samplers, kLens, batch.lens);
}

/// Camera rays that meet nothing end here.
void PathTracer::end_passing_rays(PathBatch& batch) const {
    const std::size_t n = batch.rays.size();
    batch.passes.resize(n);
    passing_rays_.find(batch.rays, batch.passes);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Ray& ray = batch.rays[i];
        if (batch.passes[i] != 0) {
            if (sees_sky_) leave(batch, batch.states[i], ray.direction);
            continue;
        }
        batch.states[kept] = batch.states[i];
        batch.rays[kept] = ray;
        ++kept;
    }
    batch.states.resize(kept);
    batch.rays.resize(kept);
    batch.counts.rays += n - kept;
    batch.counts.passing_rays += n - kept;
}

}  // namespace rayuela
