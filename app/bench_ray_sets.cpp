#include "app/bench_ray_sets.h"

#include "core/accel/surface_point.h"
#include "core/math/basis.h"
#include "core/math/float_error.h"
#include "core/math/sampling.h"

#include <algorithm>
#include <random>

namespace rayuela {
namespace {

class RayMaker {
public:
    RayMaker(const Accelerator& scene, const BenchMesh& view)
        : scene_(scene), surfaces_(scene.instances()), view_(view) {}

    std::vector<Ray> primary(int side) {
        constexpr int kBlock = 16, kBeam = 8, kSquare = 4;
        const Vec3 forward = glm::normalize(view_.target - view_.eye);
        const Vec3 right = glm::normalize(glm::cross(forward, view_.up)), up = glm::cross(right, forward);
        const float half = std::tan(glm::radians(view_.field_of_view) / 2);
        std::vector<Ray> rays;
        const auto add = [&](int column, int row) {
            const Vec2 at = (Vec2(glm::ivec2(column, row)) + sample()) / static_cast<float>(side) * 2.0f - 1.0f;
            rays.push_back(
                {.origin = view_.eye, .direction = glm::normalize(forward + half * (at.x * right - at.y * up))});
        };
        const auto each_square = [](int size, int part, const auto& use) {
            for (int y = 0; y < size; y += part) {
                for (int x = 0; x < size; x += part) use(x, y);
            }
        };
        each_square(side / kBlock * kBlock, kBlock, [&](int left, int top) {
            each_square(kBlock, kBeam, [&](int x, int y) {
                each_square(kBeam, kSquare, [&](int u, int v) {
                    each_square(kSquare, 1,
                                [&](int column, int row) { add(left + x + u + column, top + y + v + row); });
                });
            });
        });
        return rays;
    }

    /// Where the rays arrive, seen from their side.
    std::vector<SurfacePoint> arrivals(std::span<const Ray> rays) const {
        std::vector<Hit> hits(rays.size());
        scene_.intersect(rays, hits);
        std::vector<SurfacePoint> points;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (!hits[i].valid()) continue;
            SurfacePoint point = surfaces_.point(rays[i], hits[i]);
            if (glm::dot(point.ng, rays[i].direction) > 0) point.ng = -point.ng;
            points.push_back(point);
        }
        return points;
    }

    std::vector<Ray> bounce(std::span<const SurfacePoint> points) {
        std::vector<Ray> rays;
        for (const SurfacePoint& point : points) {
            const Vec3 w = Basis(point.ng).to_world(sample_cosine_hemisphere(sample()));
            rays.push_back({.origin = offset_ray_origin(point.p, point.p_error, point.ng, w), .direction = w});
        }
        return rays;
    }

    std::vector<Ray> shadow(std::span<const SurfacePoint> points) {
        std::vector<Ray> rays;
        for (const SurfacePoint& point : points) {
            const Vec2 u = sample();
            const Vec3 light = view_.light_corner + u.x * view_.light_u + u.y * view_.light_v;
            const Vec3 origin = offset_ray_origin(point.p, point.p_error, point.ng, light - point.p);
            if (glm::dot(light - point.p, point.ng) <= 0) continue;
            rays.push_back({.origin = origin, .direction = light - origin, .t_max = 0.9999f});
        }
        return rays;
    }

    std::vector<Ray> shuffled(std::vector<Ray> rays) {
        std::shuffle(rays.begin(), rays.end(), random_);
        return rays;
    }

private:
    Vec2 sample() {
        const auto uniform = [&] { return static_cast<float>(random_() >> 8) * 0x1p-24f; };
        const float x = uniform();
        return {x, uniform()};
    }

    const Accelerator& scene_;
    const Surfaces surfaces_;
    const BenchMesh& view_;
    std::mt19937 random_{1};
};

}  // namespace

std::vector<RaySet> make_ray_sets(const Accelerator& scene, const BenchMesh& view, int side) {
    RayMaker make(scene, view);
    const std::vector<Ray> primary = make.primary(side);
    const auto seen = make.arrivals(primary);
    const std::vector<Ray> bounce = make.bounce(seen);
    return {{RayKind::primary, "primary", primary},
            {RayKind::bounce, "bounce", bounce},
            {RayKind::bounce_shuffled, "bounce, shuffled", make.shuffled(bounce)},
            {RayKind::shadow, "shadow", make.shadow(seen)},
            {RayKind::shadow_from_bounce, "shadow from bounce", make.shadow(make.arrivals(bounce))}};
}

}  // namespace rayuela
