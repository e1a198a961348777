#include "core/render/passing_rays.h"

#include "core/render/render_session.h"
#include "core/render/skips.h"
#include "tests/render_testing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

/// Camera rays that pass all bounds by are not traced, and counted.
namespace rayuela {
namespace {

using namespace rayuela::testing;
using ::testing::HasSubstr;

constexpr int kSide = 64, kSamples = 4;

/// Seen through a square image of 90 degrees from 5 before the origin: 4 before the front of what reaches to z = 1.
Scene square_view() {
    Scene scene = empty_scene(kSide, kSide);
    scene.film.filter = PixelFilter::box;
    scene.render.max_samples = kSamples;
    scene.camera = {.position = Vec3(0, 0, 5), .target = Vec3(0), .vfov = 90};
    return scene;
}

std::shared_ptr<const Frame> render_frame(const Scene& scene, const Shortcuts& shortcuts = {}) {
    RenderSession session({.threads = 2, .interactive = false});
    session.set_shortcuts(shortcuts);
    session.submit(std::make_shared<const Scene>(scene));
    return session.wait({});
}

double passing_share(const Scene& scene) {
    const RenderStatistics statistics = render_frame(scene)->statistics;
    return static_cast<double>(statistics.passing_rays) / static_cast<double>(statistics.samples);
}

Skip row_of(const Frame& frame) {
    const std::vector<Skip> skips = skips_of(frame);
    return *std::ranges::find(skips, &Shortcuts::passing_rays,
                              [](const Skip& skip) { return skip.shortcut ? skip.shortcut->member : nullptr; });
}

TEST(PassingRays, AreThoseOutsideTheProjectionOfTheBounds) {
    Scene scene = square_view();
    add_object(scene, Box{Vec3(-1), Vec3(1)});
    // At the front the view is 8 wide and the box 2.
    EXPECT_NEAR(passing_share(scene), 15.0 / 16, 0.002);
    scene.objects[0].shape = Sphere{Vec3(0), 1};
    EXPECT_NEAR(passing_share(scene), 15.0 / 16, 0.002) << "a ball has the bounds of the box around it";
    scene.objects[0].shape = Quad{Vec3(-1, -2, 1), Vec3(3, 0, 0), Vec3(0, 4, 0)};
    EXPECT_NEAR(passing_share(scene), 1 - 12.0 / 64, 0.002);
    add_object(scene, Box{Vec3(-2, -1, 0), Vec3(-1, 1, 1)});
    EXPECT_NEAR(passing_share(scene), 1 - 16.0 / 64, 0.002) << "the bounds of both";
    scene.objects[1].visible = false;
    EXPECT_NEAR(passing_share(scene), 1 - 12.0 / 64, 0.002);
    scene.camera.lens_radius = 0.01f;
    scene.camera.focus_distance = 4;
    EXPECT_NEAR(passing_share(scene), 1 - 12.0 / 64, 0.002) << "in focus";
}

TEST(PassingRays, NoneWhereTheBoundsFillTheViewOrHaveNoEnd) {
    Scene scene = square_view();
    add_object(scene, Box{Vec3(-1), Vec3(1)});
    scene.camera.position.z = 0.5f;
    EXPECT_EQ(passing_share(scene), 0) << "within the bounds";
    scene.camera.position.z = 1.9f;
    EXPECT_EQ(passing_share(scene), 0) << "before a face that fills the view";
    EXPECT_EQ(row_of(*render_frame(scene)).state, SkipState::needed);
    scene.camera.position.z = 5;
    add_object(scene, Plane{.point = Vec3(0, -1, 0)});
    EXPECT_EQ(passing_share(scene), 0) << "a plane";
}

TEST(PassingRays, AllWhereNothingIsThere) {
    EXPECT_EQ(passing_share(square_view()), 1);
    Scene scene = square_view();
    add_object(scene, Sphere{Vec3(0, 0, 20), 1});
    EXPECT_EQ(passing_share(scene), 1) << "behind the camera";
}

TEST(PassingRays, AreCountedAndCanBePutBack) {
    Scene scene = square_view();
    add_object(scene, Sphere{Vec3(0), 1});
    scene.environment = GradientEnvironment{};
    const auto without = render_frame(scene), with = render_frame(scene, {.passing_rays = false});
    const RenderStatistics &a = without->statistics, &b = with->statistics;
    EXPECT_EQ(without->image.pixels, with->image.pixels);
    EXPECT_EQ(without->object_ids, with->object_ids);
    EXPECT_GT(a.passing_rays, 0u);
    EXPECT_EQ(b.passing_rays, 0u);
    EXPECT_EQ(a.rays, b.rays) << "they are rays all the same";
    EXPECT_EQ(a.environment_lookups, b.environment_lookups);
    EXPECT_EQ(row_of(*without).state, SkipState::skipped);
    EXPECT_EQ(row_of(*without).saved, a.passing_rays);
    EXPECT_THAT(row_of(*without).why, HasSubstr("93.8 %"));
    EXPECT_EQ(row_of(*with).state, SkipState::put_back);
    scene.environment = NoEnvironment{};
    EXPECT_EQ(render_frame(scene)->statistics.environment_lookups, 0u);
}

/// Rays at and around the corners and edges of the bounds, near and far, against a list and a tree.
TEST(PassingRays, HaveNoHit) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&](float scale) { return scale * Vec3(unit(random), unit(random), unit(random)); };
    int passing = 0, hits = 0;
    for (int round = 0; round < 60; ++round) {
        Scene scene = square_view();
        const float offset = round % 3 == 0 ? 0.0f : round % 3 == 1 ? 30.0f : 3000.0f;
        for (int i = 0; i < 3; ++i) {
            const Vec3 a = point(1) + offset, b = a + glm::abs(point(1));
            if (round % 2 == 0)
                add_object(scene, Box{a, b}, {}, {.rotate = glm::angleAxis(0.7f * unit(random), Vec3(0, 1, 0))});
            if (round % 2 == 1) add_object(scene, Triangle{{a, b, point(1) + offset}});
            add_object(scene, Sphere{a, 0.3f});
        }
        scene.camera.position = point(std::pow(10.0f, static_cast<float>(round % 6))) + offset;
        scene.render.accel.kind = round % 4 < 2 ? AcceleratorKind::kd : AcceleratorKind::list;
        const auto built = make_render_scene(scene);
        const PassingRays rays(built->accelerator(), CameraRays(built->camera(), 1));
        const Bounds3 bounds = built->accelerator().bounds();
        for (int i = 0; i < 3000; ++i) {
            // Of the bounds: anywhere in or beside them, on some axes next to a face.
            const Vec3 face = glm::step(Vec3(0), point(1)) + std::pow(0.1f, static_cast<float>(i % 9)) * point(1);
            const Vec3 share = glm::mix(0.5f + 0.7f * point(1), face, glm::step(Vec3(0), point(1)));
            const Vec3 target = glm::mix(bounds.lo, bounds.hi, share);
            const Ray ray{.origin = built->camera().position,
                          .direction = glm::normalize(target - built->camera().position)};
            Hit hit;
            built->accelerator().intersect({&ray, 1}, {&hit, 1});
            passing += rays.passes(ray) ? 1 : 0;
            hits += hit.valid() ? 1 : 0;
            ASSERT_FALSE(rays.passes(ray) && hit.valid()) << round << " " << i;
        }
    }
    EXPECT_GT(passing, 1000);
    EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace rayuela
