#include "core/accel/surface_point.h"
#include "core/render/camera_rays.h"
#include "core/shapes/intersect_sphere.h"
#include "tests/stress/stress.h"
#include "tests/support/oracle.h"

#include <fmt/format.h>

#include <atomic>
#include <numbers>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

/// From far away, from close to the surface, from inside; aimed within the disc, a quarter at its rim.
Ray ray_at_sphere(Random& random, const Vec3& center, float radius) {
    const float distance =
        random.integer(0, 3) ? log_uniform(random, 1e-6f, 1e6f) : radius * (1 + random.uniform(-1e-4f, 1e-4f));
    Ray ray{.origin = center + random.direction() * distance};
    const float aim = random.integer(0, 3) ? random.uniform(0, 1.2f) : random.uniform(0.9999f, 1.0001f);
    ray.direction = center + random.direction() * (radius * aim) - ray.origin;
    return ray;
}

Outcome against_long_double(double scale) {
    return for_cases(scaled(1e8, scale), 1, [](Random& random, Outcome& outcome) {
        const float radius = log_uniform(random, 1e-6f, 1e6f);
        const Vec3 center = random.integer(0, 1) ? Vec3(0) : log_uniform_vector(random, 1e-6f, 1e6f);
        const Ray ray = ray_at_sphere(random, center, radius);
        if (ray.direction == Vec3(0)) return;
        const SphereOracle expected = solve_sphere(center, radius, ray);
        if (expected.near_tangent || expected.on_surface) return;
        ShapeHit hit;
        const bool found = intersect_sphere({Vec3d(center), radius}, RayD(ray), {}, hit);
        const auto where = [&] { return fmt::format("{} radius {:.9g} {}", describe(center), radius, describe(ray)); };
        outcome.expect(found == expected.t.has_value(), where);
        if (!found || !expected.t || *expected.t < 1e-30L) return;
        const auto error = static_cast<double>(std::fabs(Real(hit.t) - *expected.t) / *expected.t);
        outcome.measure(error);
    });
}

/// Where the hit point is said to be, against the sphere's equation.
Outcome ground(double scale) {
    return for_cases(scaled(1e7, scale), 2, [](Random& random, Outcome& outcome) {
        const float radius = 1e6f;
        const GeometryInstance sphere{Sphere{Vec3(0, -radius, 0), radius}, {}};
        Ray ray{.origin = log_uniform_vector(random, 1e-3f, 1e4f)};
        ray.origin.y = std::fabs(ray.origin.y) + 1e-3f;
        ray.direction = random.direction();
        ray.direction.y = -std::fabs(ray.direction.y);
        if (random.integer(0, 1)) ray.direction.y *= log_uniform(random, 1e-3f, 1);
        Hit hit{.object = 0, .primitive = 0};
        ShapeHit shape_hit;
        if (!intersect_sphere({Vec3d(0, -radius, 0), radius}, RayD(ray), {}, shape_hit)) return;
        hit.t = shape_hit.t;
        // With the centre at (0, -R, 0): |p - c|^2 - R^2 = |p|^2 + 2 R y, without cancellation.
        const Vec3l p(surface_of(sphere, ray, hit).p);
        const Real distance = glm::length(p + Vec3l(0, radius, 0));
        const Real residual = std::fabs(p.x * p.x + p.z * p.z + p.y * (p.y + 2 * Real(radius))) / (distance + radius);
        const Vec3l n = (p + Vec3l(0, radius, 0)) / distance;
        outcome.measure(static_cast<double>(residual / (kU * glm::dot(glm::abs(n), glm::abs(p)))));
    });
}

/// Share of a stratified image that a sphere 1e4 radii from the origin fills, against the disc that it is.
Outcome silhouette(double scale) {
    const auto side = static_cast<std::uint64_t>(std::sqrt(double(scaled(1e8 / 6, scale, 1 << 20))));
    Outcome total;
    for (const Vec3& center : {Vec3(1e4f, 0, 0), Vec3(-6e3f, 5e3f, 6.2e3f)}) {
        for (const float nominal_distance : {1.5f, 5.0f, 40.0f}) {
            Camera view;
            view.target = center;
            view.position = center + Vec3(0, nominal_distance, 0);
            view.up = Vec3(0, 0, 1);
            const double distance = double(view.position.y) - double(center.y);
            const double tangent = 1 / std::sqrt(distance * distance - 1);
            view.vfov = static_cast<float>(glm::degrees(2 * std::atan(1.2 * tangent)));
            const double image_half = std::tan(glm::radians(double(view.vfov)) / 2);
            const double expected = std::numbers::pi * tangent * tangent / (4 * image_half * image_half);

            const CameraRays camera(view, 1);
            const auto accelerator = build({{Sphere{center, 1}, {}}}, {.kind = AcceleratorKind::kd});
            std::atomic<std::uint64_t> found = 0;
            Outcome outcome = for_batches(side, 3, 1, [&](Random& random, std::uint64_t y, std::uint64_t, Outcome&) {
                std::uint64_t hits = 0;
                for (std::uint64_t x = 0; x < side; ++x) {
                    const Vec2 cell(static_cast<float>(x), static_cast<float>(y));
                    const Vec2 position = (cell + Vec2(random.uniform(), random.uniform())) / static_cast<float>(side);
                    if (intersect(*accelerator, camera.ray(position, Vec2(0))).valid()) ++hits;
                }
                found += hits;
            });
            outcome.cases *= side;
            const double share = static_cast<double>(found) / static_cast<double>(outcome.cases);
            outcome.measure(std::fabs(share / expected - 1));
            total.add(outcome);
        }
    }
    return total;
}

}  // namespace

std::vector<StressTest> sphere_tests() {
    return {{1, "sphere: t against long double", "relative error of t", 1.2e-7, against_long_double},
            {2, "ground sphere of 1e6: residual of the hit point", "units of u sum|n p|", 2, ground},
            {3, "sphere 1e4 radii from the origin: silhouette", "relative area", 1e-4, silhouette}};
}

}  // namespace rayuela::stress
