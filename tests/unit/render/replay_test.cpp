#include "core/render/replay.h"
#include "tests/render_testing.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

/// A white plane two below the camera under a sky of radiance 1.
Scene lit_floor() {
    Scene scene = testing::empty_scene(1, 1);
    scene.camera.position = Vec3(0, 2, 0);
    scene.camera.target = Vec3(0);
    scene.camera.up = Vec3(0, 0, -1);
    scene.camera.vfov = 0.1f;
    scene.environment = ConstantEnvironment{Color(1)};
    scene.render.max_bounces = 1;
    const MaterialId white = testing::add_material(scene, Diffuse{{Color(0.5f), nullptr}});
    testing::add_object(scene, Plane{}, white);
    return scene;
}

TEST(Replay, TellsWhatTheRaysMet) {
    const Replay found = replay(*testing::make_render_scene(lit_floor()), {0, 0});
    ASSERT_EQ(found.rows.size(), 2u);
    const ReplayRow& floor = found.rows[0];
    EXPECT_EQ(floor.bounce, 0);
    EXPECT_EQ(floor.object, "o2 (0)");
    EXPECT_EQ(floor.material, "diffuse");
    EXPECT_EQ(floor.throughput, "(1 1 1)");
    EXPECT_EQ(floor.pdf, "delta");
    EXPECT_NEAR(std::stod(floor.t), 2, 1e-5);
    EXPECT_THAT(floor.normal, ::testing::StartsWith("(0 1 0) shading (0 1 0)"));
    EXPECT_EQ(floor.light, "");
    EXPECT_EQ(floor.radiance, "(0 0 0)");
    const ReplayRow& sky = found.rows[1];
    EXPECT_EQ(sky.bounce, 1);
    EXPECT_EQ(sky.object, "environment");
    EXPECT_EQ(sky.throughput, "(0.5 0.5 0.5)");
    EXPECT_EQ(sky.light, "(1 1 1)");
    EXPECT_EQ(sky.weight, "1 (light pdf 0)") << "a constant sky is not sampled";
    EXPECT_EQ(sky.radiance, "(0.5 0.5 0.5)");
    EXPECT_EQ(found.radiance, Color(0.5f));
}

TEST(Replay, IsTheSampleOfTheFilm) {
    Scene scene = testing::mixed_scene(12, 8);
    // Without mirrors and glass no light path has a share in the image.
    for (MaterialEntry& entry : scene.materials) {
        if (has_delta_lobe(entry.material)) entry.material = Diffuse{};
    }
    const auto plain = testing::render(scene, 1);
    const auto plain_scene = testing::make_render_scene(scene);
    ASSERT_FALSE(plain_scene->emission());
    for (std::uint32_t pixel = 0; pixel < 96; ++pixel)
        EXPECT_EQ(Vec3d(replay(*plain_scene, {pixel, 0}).radiance), plain->film().mean(pixel)) << pixel;
}

TEST(Replay, TextHasEveryFieldOfEveryRow) {
    const auto scene = testing::make_render_scene(testing::mixed_scene(12, 8));
    for (std::uint32_t pixel = 0; pixel < 96; pixel += 7) {
        const Replay found = replay(*scene, {pixel, 2});
        const std::string text = to_text(found);
        ASSERT_FALSE(found.rows.empty());
        for (const ReplayRow& row : found.rows) {
            for (const ReplayField& field : kReplayFields) EXPECT_THAT(text, ::testing::HasSubstr(row.*field.text));
        }
        EXPECT_THAT(text, ::testing::EndsWith("sample " + to_text(found.radiance) + "\n"));
    }
}

}  // namespace
}  // namespace rayuela
