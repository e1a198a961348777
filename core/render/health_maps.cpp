#include "core/render/health_maps.h"

#include "core/math/float_error.h"
#include "core/render/camera_rays.h"

#include <cmath>

namespace rayuela {

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

std::size_t pixels(const glm::ivec2& size) {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
}

CameraRays camera_of(const RenderScene& scene) {
    const FilmSettings& film = scene.scene().film;
    return {scene.camera(), static_cast<double>(film.width) / film.height};
}

/// value(pixel, ray, hit) of each pixel.
template <typename Value>
std::vector<float> map_of_hits(const RenderScene& scene, const glm::ivec2& size, const std::atomic<bool>& cancelled,
                               const Value& value) {
    const CameraRays camera = camera_of(scene);
    std::vector<Ray> rays(static_cast<std::size_t>(size.x));
    std::vector<Hit> hits(rays.size());
    std::vector<float> map;
    map.reserve(pixels(size));
    for (int y = 0; y < size.y; ++y) {
        if (cancelled) return {};
        for (std::size_t x = 0; x < rays.size(); ++x)
            rays[x] = camera.ray((Vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f) / Vec2(size), Vec2(0));
        scene.accelerator().intersect(rays, hits);
        for (std::size_t x = 0; x < rays.size(); ++x) map.push_back(value(map.size(), rays[x], hits[x]));
    }
    return map;
}

float relative_error(const SurfacePoint& point, const Ray& ray) {
    return static_cast<float>(glm::length(Vec3d(point.p_error)) / glm::length(Vec3d(point.p) - Vec3d(ray.origin)));
}

}  // namespace

std::vector<float> sample_map(std::span<const SampledBlock> blocks, int elsewhere, const glm::ivec2& size) {
    std::vector<float> map(pixels(size), static_cast<float>(elsewhere));
    for (const SampledBlock& block : blocks) {
        for (int y = block.y0; y < std::min(block.y1, size.y); ++y) {
            for (int x = block.x0; x < std::min(block.x1, size.x); ++x)
                map[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)] =
                    static_cast<float>(block.samples);
        }
    }
    return map;
}

std::vector<float> rejected_map(std::span<const RejectedPixel> rejected, const glm::ivec2& size) {
    std::vector<float> map(pixels(size));
    for (const RejectedPixel& r : rejected) {
        if (r.pixel < map.size()) map[r.pixel] = static_cast<float>(r.samples);
    }
    return map;
}

std::vector<float> position_error_map(const RenderScene& scene, const glm::ivec2& size,
                                      const std::atomic<bool>& cancelled) {
    return map_of_hits(scene, size, cancelled, [&](std::size_t, const Ray& ray, const Hit& hit) {
        return hit.valid() ? relative_error(scene.surfaces().point(ray, hit, false), ray) : kNothing;
    });
}

float disagreement(const Hit& hit, const ReferenceHit& reference) {
    if (!hit.valid() && !reference.valid()) return kNothing;
    if (hit.valid() != reference.valid()) return kInfinity;
    const double apart = std::fabs(double{hit.t} - reference.t);
    const bool same = hit.object == reference.object && hit.primitive == reference.primitive;
    if (!same && apart > 2 * double{kUnitRoundoff} * reference.t) return kInfinity;
    return apart == 0 ? 0 : static_cast<float>(apart / reference.t);
}

std::vector<float> retrace_map(const RenderScene& scene, const glm::ivec2& size, const std::atomic<bool>& cancelled) {
    const std::vector<ReferenceHit> reference =
        reference_trace(scene.accelerator().instances(), camera_of(scene), size, cancelled);
    if (reference.empty()) return {};
    return map_of_hits(scene, size, cancelled, [&](std::size_t pixel, const Ray&, const Hit& hit) {
        return disagreement(hit, reference[pixel]);
    });
}

}  // namespace rayuela
