#include "core/render/render_scene.h"

#include "tests/render_testing.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

using namespace rayuela::testing;

/// Two spheres, a million away from the origin.
Scene far_scene() {
    Scene scene = empty_scene(64, 64);
    const Vec3 far(1e6f, -2e6f, 5e5f);
    add_object(scene, Sphere{}, {}, {.translate = far});
    add_object(scene, Sphere{Vec3(0, 3, 0), 0.5f}, {}, {.translate = far});
    scene.camera.position = far + Vec3(0, 0, 5);
    scene.camera.target = far;
    return scene;
}

TEST(RenderScene, FarObjectsAreTracedNextToTheOrigin) {
    const auto far = make_render_scene(far_scene());
    EXPECT_LT(max_component(glm::abs(far->accelerator().bounds().hi)), 8);
    EXPECT_EQ(far->camera().position + far->origin(), far->scene().camera.position);
    EXPECT_EQ(make_render_scene(mixed_scene(8, 8))->origin(), Vec3(0)) << "what is near stays where it is";
}

TEST(RenderScene, FarObjectsArePickedWhereTheyAre) {
    const Scene scene = far_scene();
    const auto picked = pick(*make_render_scene(scene), Vec2(0.5f));
    ASSERT_TRUE(picked);
    EXPECT_EQ(picked->object, scene.objects[0].id);
    EXPECT_EQ(picked->point, scene.objects[0].transform.translate + Vec3(0, 0, 1));
    EXPECT_NEAR(picked->distance, 4, 1e-5);
}

/// Where moving would round, nothing is moved.
TEST(RenderScene, WhatCannotBeMovedExactlyStays) {
    Scene scene = far_scene();
    add_object(scene, Sphere{Vec3(1e6f, -2e6f, 5e5f), 1}, {}, {.translate = Vec3(0.1f)});
    EXPECT_EQ(make_render_scene(scene)->origin(), Vec3(0));
}

}  // namespace
}  // namespace rayuela
