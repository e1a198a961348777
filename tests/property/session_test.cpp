#include "core/render/render_session.h"

#include "core/scene/scene_edit.h"
#include "tests/render_testing.h"
#include "tests/support/eventually.h"
#include "tests/support/random_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

namespace rayuela {
namespace {

using namespace rayuela::testing;
using test::eventually;
using namespace std::chrono_literals;

using Clock = std::chrono::steady_clock;

std::shared_ptr<const Scene> share(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

Scene limited(Scene scene, int max_samples) {
    scene.render.max_samples = max_samples;
    return scene;
}

std::shared_ptr<const Frame> render_headless(const Scene& scene, int threads = 2) {
    RenderSession session({.threads = threads, .interactive = false});
    session.submit(share(scene));
    return session.wait({});
}

TEST(Session, HeadlessRendersToTheSampleLimit) {
    const Scene scene = limited(mixed_scene(70, 50), 5);
    const auto frame = render_headless(scene);
    ASSERT_TRUE(frame);
    EXPECT_FALSE(frame->coarse);
    EXPECT_EQ(frame->version, 1u);
    EXPECT_EQ(*frame->scene, scene);
    const RenderStatistics& statistics = frame->statistics;
    EXPECT_EQ(statistics.phase, SessionPhase::finished);
    EXPECT_EQ(statistics.spp, 5);
    EXPECT_EQ(statistics.samples, 70u * 50 * 5);
    EXPECT_GT(statistics.rays, statistics.samples);
    EXPECT_GT(statistics.shadow_rays, 0u);
    EXPECT_THAT(statistics.rejected, ::testing::Each(0u));
    EXPECT_GT(statistics.render_seconds, 0);
    EXPECT_GT(statistics.samples_per_second, 0);
    EXPECT_GT(statistics.estimated_error, 0);
    EXPECT_GT(statistics.accel.primitives, 500u);
    EXPECT_GT(statistics.memory_bytes, 70u * 50 * 50);
    EXPECT_EQ(statistics.restarts, 1u);
    EXPECT_EQ(statistics.threads, 2);
    EXPECT_EQ(frame->image.pixels, render(scene, 5)->film().image().pixels);
}

TEST(Session, ObjectIdsAreThoseOfThePixels) {
    Scene scene = limited(empty_scene(64, 64), 1);
    scene.camera.position = Vec3(0, 0, 5);
    scene.camera.target = Vec3(0);
    const ObjectId list = add_object(scene, ObjectList{});
    const ObjectId ball = add_object(scene, Sphere{Vec3(0), 1});
    scene.objects.back().parent = list;
    const ObjectId wall = add_object(scene, Quad{Vec3(-9, -9, -2), Vec3(18, 0, 0), Vec3(0, 9, 0)});
    const auto frame = render_headless(scene);
    const auto at = [&](std::size_t x, std::size_t y) { return ObjectId{frame->object_ids.at(y * 64 + x)}; };
    EXPECT_EQ(at(32, 32), ball);
    EXPECT_EQ(at(2, 60), wall);
    EXPECT_EQ(at(2, 2), ObjectId{});

    const auto picked = pick(*frame->render_scene, Vec2(0.5f));
    ASSERT_TRUE(picked);
    EXPECT_EQ(picked->object, ball);
    EXPECT_NEAR(picked->distance, 4, 1e-4);
    EXPECT_NEAR(picked->point.z, 1, 1e-4);
    EXPECT_NEAR(picked->normal.z, 1, 1e-4);
    // Away from the axis focus distance is measured along it, not along the ray.
    const auto corner = pick(*frame->render_scene, Vec2(0.05f, 0.95f));
    ASSERT_TRUE(corner);
    EXPECT_EQ(corner->object, wall);
    EXPECT_NEAR(corner->distance, 7, 1e-4);
    EXPECT_FALSE(pick(*frame->render_scene, Vec2(0.05f)));
}

TEST(Session, HiddenGroupsAreNotSeen) {
    Scene scene = limited(empty_scene(8, 8), 1);
    scene.camera.position = Vec3(0, 0, 5);
    scene.camera.target = Vec3(0);
    scene.objects.reserve(4);
    const ObjectId outer = add_object(scene, ObjectList{});
    add_object(scene, ObjectList{});
    scene.objects.back().parent = outer;
    scene.objects.back().transform.translate = Vec3(0, 0, -1);
    const ObjectId inner = scene.objects.back().id;
    const ObjectId ball = add_object(scene, Sphere{Vec3(0), 1});
    scene.objects.back().parent = inner;
    const auto picked = pick(*make_render_scene(scene), Vec2(0.5f));
    ASSERT_TRUE(picked);
    EXPECT_EQ(picked->object, ball);
    EXPECT_NEAR(picked->distance, 5, 1e-4) << "moved by the list it is in";
    scene.objects[0].visible = false;
    EXPECT_FALSE(pick(*make_render_scene(scene), Vec2(0.5f)));
}

TEST(Session, RaisingTheLimitContinues) {
    const Scene scene = mixed_scene(50, 40);
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(share(limited(scene, 3)));
    EXPECT_EQ(session.wait({})->statistics.spp, 3);
    session.submit(share(limited(scene, 7)));
    const auto frame = session.wait({});
    EXPECT_EQ(frame->statistics.spp, 7);
    EXPECT_EQ(frame->statistics.restarts, 1u);
    EXPECT_EQ(frame->statistics.samples, 50u * 40 * 7);
    EXPECT_EQ(frame->image.pixels, render_headless(limited(scene, 7))->image.pixels);
}

TEST(Session, AnotherAcceleratorKeepsTheFilm) {
    Scene scene = limited(mixed_scene(50, 40), 4);
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(share(scene));
    const auto before = session.wait({});
    scene.render.accel = {.kind = AcceleratorKind::kd, .leaf_size = 2, .split = KdSplit::median};
    session.submit(share(scene));
    const auto after = session.wait({});
    EXPECT_GT(after->version, before->version);
    EXPECT_GT(after->statistics.accel.leaves, before->statistics.accel.leaves);
    EXPECT_EQ(after->statistics.restarts, 1u);
    EXPECT_EQ(after->statistics.samples, before->statistics.samples) << "nothing was traced again";
    EXPECT_EQ(after->image.pixels, before->image.pixels);
    scene.render.max_samples = 6;
    scene.render.accel.kind = AcceleratorKind::list;
    session.submit(share(scene));
    EXPECT_EQ(session.wait({})->image.pixels, render_headless(limited(scene, 6))->image.pixels);
}

TEST(Session, RestartGivesTheSameImageAgain) {
    const Scene scene = limited(mixed_scene(50, 40), 3);
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(share(scene));
    const auto first = session.wait({});
    session.restart();
    const auto second = session.wait({});
    EXPECT_EQ(second->statistics.restarts, 2u);
    EXPECT_GT(second->version, first->version);
    EXPECT_EQ(second->image.pixels, first->image.pixels);
}

TEST(Session, TimeLimitEndsRenderingWithAWholeImage) {
    Scene scene = mixed_scene(200, 150);
    scene.render.max_seconds = 0.2;
    const auto frame = render_headless(scene);
    EXPECT_EQ(frame->statistics.phase, SessionPhase::finished);
    EXPECT_GE(frame->statistics.spp, 1);
    EXPECT_GE(frame->statistics.render_seconds, 0.2);
    const auto expected = render(scene, 1);
    // Pixels of unfinished tiles have one sample less than their neighbours, none has none.
    for (std::size_t i = 0; i < 200 * 150; ++i) {
        if (expected->film().mean(i) != Vec3d(0)) {
            ASSERT_NE(Vec3(frame->image.pixels[i]), Vec3(0)) << i;
        }
    }
}

TEST(Session, InterruptedWaitReturnsWhatIsThere) {
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(share(mixed_scene(60, 40)));
    std::uint64_t samples = 0;
    const auto frame = session.wait([&](const SessionStatus& status, const RenderStatistics& statistics) {
        EXPECT_EQ(status.submitted, 1u);
        samples = statistics.samples;
        return statistics.spp >= 1;
    });
    ASSERT_TRUE(frame);
    EXPECT_GE(frame->statistics.samples, samples);
    EXPECT_EQ(frame->image.pixels.size(), 60u * 40);
}

TEST(Session, InterruptedBeforeTheFirstSceneHasNoFrame) {
    RenderSession session({.threads = 1, .interactive = false});
    EXPECT_FALSE(session.wait([](const SessionStatus& status, const RenderStatistics&) {
        EXPECT_EQ(status.phase, SessionPhase::idle);
        return true;
    }));
    EXPECT_FALSE(session.frame());
}

TEST(Session, RejectedSamplesAreReported) {
    Scene scene = limited(empty_scene(16, 16), 3);
    scene.environment = ConstantEnvironment{Color(-1)};
    const auto frame = render_headless(scene);
    EXPECT_THAT(frame->statistics.rejected, ::testing::ElementsAre(0u, 0u, 16u * 16 * 3));
    EXPECT_EQ(Vec3(frame->image.pixels[0]), Vec3(0));
}

TEST(Session, InteractiveStartsCoarseAndEndsAsHeadless) {
    const Scene scene = limited(mixed_scene(320, 180), 2);
    std::vector<std::shared_ptr<const Frame>> frames;  // Written by the render thread until the session is finished.
    RenderSession session({.threads = 2, .interactive = true});
    session.on_publish([&] { frames.push_back(session.frame()); });
    session.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return session.status().phase == SessionPhase::finished; }));
    ASSERT_GE(frames.size(), 2u);
    EXPECT_TRUE(frames.front()->coarse);
    EXPECT_FALSE(frames.back()->coarse);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const Frame& frame = *frames[i];
        EXPECT_EQ(frame.coarse, frame.image.width < 320);
        EXPECT_EQ(frame.object_ids.size(), frame.image.pixels.size());
        EXPECT_EQ(frame.version, i + 1);
        EXPECT_FALSE(i > 0 && frame.coarse && !frames[i - 1]->coarse) << "no way back to a preview without an edit";
    }
    EXPECT_EQ(session.frame()->image.pixels, render_headless(scene)->image.pixels);
}

/// While edits arrive at the rate of a display, each of them an obstacle to the pass under way, the view must live.
TEST(Session, AStreamOfEditsKeepsTheViewAlive) {
    Scene scene = mixed_scene(480, 270);
    RenderSession session({.threads = 2, .interactive = true});
    session.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return session.frame() != nullptr; }));
    std::uint64_t updates = 0, version = session.frame()->version;
    int edits = 0;
    ASSERT_TRUE(eventually([&] {
        scene.camera.position.x = 0.01f * static_cast<float>(++edits);
        session.submit(share(scene));
        std::this_thread::sleep_for(15ms);
        const std::uint64_t now = session.frame()->version;
        updates += now - version;
        version = now;
        return updates >= 10;
    }));
    ASSERT_TRUE(eventually([&] { return session.frame()->scene->camera == scene.camera; }));
    ASSERT_TRUE(eventually([&] { return !session.frame()->coarse; })) << "full resolution takes over by itself";
}

TEST(Session, SubmitNeverWaits) {
    Scene scene = mixed_scene(320, 180);
    RenderSession session({.threads = 2, .interactive = true});
    std::vector<double> milliseconds;
    for (int i = 0; i < 100; ++i) {
        scene.camera.position.x = 0.01f * static_cast<float>(i);
        const auto snapshot = share(scene);
        const auto start = Clock::now();
        session.submit(snapshot);
        session.frame();
        session.status();
        milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        std::this_thread::sleep_for(2ms);
    }
    EXPECT_EQ(session.status().submitted, 100u);
    std::ranges::sort(milliseconds);
    EXPECT_LT(milliseconds[50], 1.0) << "the median, for the machine may be busy otherwise";
}

TEST(Session, PausedKeepsTheFrameAndShowsEdits) {
    Scene scene = mixed_scene(64, 48);
    RenderSession session({.threads = 2, .interactive = true});
    session.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return session.frame() && session.frame()->statistics.spp >= 1; }));
    session.set_paused(true);
    ASSERT_TRUE(eventually([&] { return session.status().phase == SessionPhase::paused; }));
    const auto kept = session.frame();
    std::this_thread::sleep_for(50ms);
    EXPECT_EQ(session.frame(), kept);

    scene.camera.vfov = 30;
    session.submit(share(scene));
    ASSERT_TRUE(
        eventually([&] { return session.status().taken == 2 && session.status().phase == SessionPhase::paused; }));
    const auto edited = session.frame();
    EXPECT_EQ(edited->scene->camera.vfov, 30);
    EXPECT_EQ(edited->statistics.spp, 1);
    EXPECT_FALSE(edited->coarse);

    session.set_paused(false);
    ASSERT_TRUE(eventually([&] { return session.frame()->statistics.spp > 1; }));
    EXPECT_EQ(session.frame()->statistics.restarts, 2u);
}

TEST(Session, ThreadsChangeLiveWithoutATrace) {
    const Scene scene = limited(mixed_scene(160, 120), 12);
    RenderSession session({.threads = 1, .interactive = false});
    session.submit(share(scene));
    for (const int threads : {4, 2, 8, 3}) {
        session.set_threads(threads);
        std::this_thread::sleep_for(5ms);
    }
    const auto frame = session.wait({});
    EXPECT_EQ(frame->statistics.threads, 3);
    EXPECT_EQ(frame->statistics.restarts, 1u);
    EXPECT_EQ(frame->image.pixels, render_headless(scene, 1)->image.pixels);
}

TEST(Session, EmptySceneShowsTheSky) {
    Scene scene = limited(empty_scene(20, 10), 2);
    scene.environment = ConstantEnvironment{Color(0.25f)};
    const auto frame = render_headless(scene);
    EXPECT_THAT(frame->image.pixels, ::testing::Each(Vec4(0.25f, 0.25f, 0.25f, 1)));
    EXPECT_EQ(frame->statistics.shadow_rays, 0u);
}

TEST(Session, WithoutLightOnlyCameraRaysAreTraced) {
    Scene scene = limited(mixed_scene(32, 32), 2);
    scene.environment = NoEnvironment{};
    scene.objects.resize(scene.objects.size() - 2);  // The lamps.
    const auto frame = render_headless(scene);
    EXPECT_EQ(frame->statistics.rays, frame->statistics.samples);
    EXPECT_EQ(frame->statistics.shadow_rays, 0u);
}

TEST(Session, NoShadowRaysWithoutLightsOrBetweenMirrors) {
    Scene scene = limited(empty_scene(32, 32), 2);
    scene.environment = ConstantEnvironment{Color(1)};
    const MaterialId mirror = add_material(scene, Metal{});
    add_object(scene, Sphere{Vec3(0, 1, 0), 1}, mirror);
    EXPECT_EQ(render_headless(scene)->statistics.shadow_rays, 0u);
    const MaterialId lamp = add_material(scene, Emitter{});
    add_object(scene, Sphere{Vec3(2, 3, 0), 0.5f}, lamp);
    EXPECT_EQ(render_headless(scene)->statistics.shadow_rays, 0u);
    add_object(scene, Plane{}, {});
    EXPECT_GT(render_headless(scene)->statistics.shadow_rays, 0u);
}

/// Whatever happened before, the image is that of a fresh start on the final scene.
TEST(Session, AnySequenceOfEditsEqualsAFreshStart) {
    std::mt19937 random(11);
    for (int round = 0; round < 6; ++round) {
        Scene scene = limited(mixed_scene(96, 64), 2);
        const bool interactive = round % 2 == 0;
        RenderSession session({.threads = 2, .interactive = interactive});
        session.submit(share(scene));
        for (int i = 0; i < 25; ++i) {
            const auto edited = rayuela::apply(scene, random_edit(scene, random));
            if (!edited) continue;
            scene = *edited;
            session.submit(share(scene));
            if (random() % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(random() % 15));
        }
        ASSERT_TRUE(eventually([&] {
            const SessionStatus status = session.status();
            return status.taken == status.submitted && status.phase == SessionPhase::finished;
        }));
        EXPECT_TRUE(is_fresh(*session.frame(), *render_headless(scene))) << "round " << round;
    }
}

TEST(Session, ShutsDownInTheMiddleOfABuildOrAPass) {
    Scene scene = mixed_scene(1280, 720);
    add_object(scene, Mesh{"large", torus_mesh(500, 300)}, scene.materials[0].id);
    for (const auto delay : {0ms, 20ms, 200ms}) {
        RenderSession session({.threads = 2, .interactive = false});
        session.submit(share(scene));
        std::this_thread::sleep_for(delay);
        scene.render.accel.leaf_size += 1;
        session.submit(share(scene));
        EXPECT_EQ(session.status().submitted, 2u);
    }
}

}  // namespace
}  // namespace rayuela
