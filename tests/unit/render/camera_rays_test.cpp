#include "core/render/camera_rays.h"

#include "core/math/sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rayuela {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
    EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(CameraRays, CornersFollowFromFieldOfViewAndAspect) {
    Camera camera;
    camera.position = Vec3(1, 2, 3);
    camera.target = Vec3(1, 2, -7);
    camera.vfov = 90;
    const CameraRays rays(camera, 2);
    expect_near(rays.ray(Vec2(0.5f), Vec2(0)).direction, Vec3(0, 0, -1), 1e-6f);
    expect_near(rays.ray(Vec2(0, 0), Vec2(0)).direction, glm::normalize(Vec3(-2, 1, -1)), 1e-6f);
    expect_near(rays.ray(Vec2(1, 1), Vec2(0)).direction, glm::normalize(Vec3(2, -1, -1)), 1e-6f);
    EXPECT_EQ(rays.ray(Vec2(0.3f), Vec2(0.7f, 0)).origin, camera.position);
}

TEST(CameraRays, LensRaysMeetOnTheFocusPlane) {
    Camera camera;
    camera.position = Vec3(0, 0, 10);
    camera.target = Vec3(0);
    camera.vfov = 60;
    camera.lens_radius = 0.5f;
    camera.focus_distance = 4;
    const CameraRays rays(camera, 1.5);
    const auto on_focus_plane = [](const Ray& ray) { return ray.at((6 - ray.origin.z) / ray.direction.z); };
    for (const Vec2 position : {Vec2(0.1f, 0.2f), Vec2(0.9f, 0.5f)}) {
        const Vec3 expected = on_focus_plane(rays.ray(position, Vec2(0)));
        for (const Vec2 lens : {Vec2(1, 0), Vec2(0, -1), Vec2(-0.6f, 0.3f)}) {
            const Ray ray = rays.ray(position, lens);
            expect_near(ray.origin, Vec3(0.5f * lens, 10), 1e-6f);
            expect_near(on_focus_plane(ray), expected, 1e-5f);
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6f);
        }
    }
}

TEST(CameraRays, ViewIsTheReverseOfRay) {
    for (const float lens_radius : {0.0f, 0.4f}) {
        Camera camera;
        camera.position = Vec3(1, 2, 3);
        camera.target = Vec3(-2, 1, 0);
        camera.vfov = 70;
        camera.lens_radius = lens_radius;
        camera.focus_distance = 3;
        const CameraRays rays(camera, 1.4);
        for (const Vec2 position : {Vec2(0.1f, 0.2f), Vec2(0.9f, 0.5f), Vec2(0.5f), Vec2(1.2f, -0.3f)}) {
            for (const Vec2 lens : {Vec2(0), Vec2(1, 0), Vec2(-0.6f, 0.3f)}) {
                for (const float t : {0.1f, 2.0f, 50.0f}) {
                    const Ray ray = rays.ray(position, lens);
                    const auto view = rays.view(ray.at(t), lens);
                    ASSERT_TRUE(view);
                    EXPECT_EQ(view->origin, ray.origin);
                    EXPECT_LT(glm::length(view->position - position), 1e-5f);
                    EXPECT_FALSE(rays.view(ray.at(-t), lens)) << "behind";
                }
            }
        }
    }
}

TEST(CameraRays, DensityIsThatOfTheRays) {
    Camera camera;
    camera.vfov = 90;
    for (const float lens_radius : {0.0f, 0.4f}) {
        camera.lens_radius = lens_radius;
        const CameraRays rays(camera, 1.5);
        for (const Vec2 position : {Vec2(0.5f), Vec2(0.05f, 0.1f), Vec2(0.9f, 0.3f)}) {
            const Vec2 lens(0.3f, -0.8f);
            constexpr float kStep = 1e-2f;
            const auto direction = [&](float x, float y) {
                return rays.ray(position + kStep * Vec2(x, y), lens).direction;
            };
            const Vec3 across = direction(0.5f, 0) - direction(-0.5f, 0),
                       down = direction(0, 0.5f) - direction(0, -0.5f);
            const float solid_angle = glm::length(glm::cross(across, down));
            EXPECT_NEAR(rays.density(direction(0, 0)) * solid_angle / (kStep * kStep), 1, 1e-3);
        }
    }
}

TEST(PixelFilter, DensityIsThatOfTheSamples) {
    for (const PixelFilter filter : {PixelFilter::box, PixelFilter::tent, PixelFilter::gaussian}) {
        // Shares of a grid of cells that covers the largest filter.
        constexpr int kCells = 12, kSamples = 1 << 16, kPoints = 16;
        constexpr float kSide = 3.2f / kCells;
        std::array<std::array<double, kCells>, kCells> share{};
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            const Vec2 offset = sample_filter(filter, Sampler(SamplerKind::sobol, 0, 0, i).get_2d(0));
            EXPECT_LE(std::max(std::abs(offset.x), std::abs(offset.y)), filter_radius(filter));
            const glm::ivec2 cell((offset + 1.6f) / kSide);
            share[static_cast<std::size_t>(cell.y)][static_cast<std::size_t>(cell.x)] += 1.0 / kSamples;
        }
        for (int y = 0; y < kCells; ++y) {
            for (int x = 0; x < kCells; ++x) {
                double mass = 0;
                for (int k = 0; k < kPoints * kPoints; ++k) {
                    const Vec2 inside((static_cast<float>(k % kPoints) + 0.5f) / kPoints,
                                      (static_cast<float>(k / kPoints) + 0.5f) / kPoints);
                    mass += filter_density(filter, (Vec2(glm::ivec2(x, y)) + inside) * kSide - 1.6f);
                }
                mass *= kSide * kSide / (kPoints * kPoints);
                EXPECT_NEAR(share[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)], mass, 2e-3);
            }
        }
    }
}

TEST(CameraRays, DegenerateViewsGiveUnitDirections) {
    Camera along_up;
    along_up.position = Vec3(0, 5, 0);
    along_up.target = Vec3(0);
    Camera no_target;
    no_target.target = no_target.position;
    Camera far_away;
    far_away.position = Vec3(1e30f, 0, 0);
    far_away.target = Vec3(-1e30f, 0, 0);
    for (const Camera& camera : {along_up, no_target, far_away}) {
        const Ray ray = CameraRays(camera, 1.5).ray(Vec2(0.2f, 0.9f), Vec2(0));
        EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6f);
    }
}

/// Scaling a scene by a power of two scales every number exactly: directions keep their bits.
TEST(CameraRays, DirectionsDoNotDependOnScale) {
    Camera camera;
    camera.position = Vec3(0.3f, 1.7f, 5.1f);
    camera.target = Vec3(-0.2f, 0.9f, 0.4f);
    camera.lens_radius = 0.03f;
    camera.focus_distance = 4.7f;
    Camera scaled = camera;
    const float scale = 0x1p-15f;
    scaled.position *= scale;
    scaled.target *= scale;
    scaled.lens_radius *= scale;
    scaled.focus_distance *= scale;
    const Ray a = CameraRays(camera, 1.3).ray(Vec2(0.23f, 0.71f), Vec2(0.4f, -0.3f));
    const Ray b = CameraRays(scaled, 1.3).ray(Vec2(0.23f, 0.71f), Vec2(0.4f, -0.3f));
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.origin * scale, b.origin);
}

struct FilterCase {
    PixelFilter filter;
    float radius;
    double variance;  ///< Of one coordinate, in closed form.
};

class Filters : public testing::TestWithParam<FilterCase> {};

TEST_P(Filters, HaveTheRightSupportAndVariance) {
    const auto [filter, radius, variance] = GetParam();
    constexpr std::uint32_t kSamples = 1 << 16;
    double sum = 0, squares = 0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Vec2 offset = sample_filter(filter, Sampler(SamplerKind::sobol, 0, 0, i).get_2d(0));
        EXPECT_LE(std::abs(offset.x), radius);
        EXPECT_LE(std::abs(offset.y), radius);
        sum += offset.x;
        squares += static_cast<double>(offset.x) * offset.x;
    }
    EXPECT_NEAR(sum / kSamples, 0, 1e-3);
    EXPECT_NEAR(squares / kSamples, variance, 1e-3);
}

// Gaussian of sigma^2 = 1/4 cut at r = 3/2: E[x^2] = sigma^2 (1 - k e^-k / (1 - e^-k)) with k = r^2 / (2 sigma^2) = 4.5.
INSTANTIATE_TEST_SUITE_P(
    All, Filters,
    testing::Values(FilterCase{PixelFilter::box, 0.5f, 1.0 / 12}, FilterCase{PixelFilter::tent, 1, 1.0 / 6},
                    FilterCase{PixelFilter::gaussian, 1.5f, 0.25 * (1 - 4.5 * std::exp(-4.5) / (1 - std::exp(-4.5)))}));

}  // namespace
}  // namespace rayuela
