#include "core/scene/light_factor.h"

#include "core/scene/scene_diff.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <limits>

namespace rayuela {
namespace {

using namespace rayuela::testing;

constexpr std::optional<Vec3d> kNone = std::nullopt;

/// Two lamps, a ball of clay and a sky; another lamp's material that nothing visible has.
class LightFactor : public ::testing::Test {
protected:
    LightFactor() {
        const MaterialId large = add_material(scene, Emitter{.radiance = {Color(4, 2, 0), nullptr}});
        const MaterialId small =
            add_material(scene, Principled{.emissive = {Color(0.5f, 0.25f, 0), nullptr}, .emissive_strength = 8});
        const MaterialId spare = add_material(scene, Emitter{});
        add_object(scene, Sphere{}, large);
        add_object(scene, Sphere{}, small);
        add_object(scene, Sphere{}, add_material(scene, Diffuse{}));
        add_object(scene, Sphere{}, spare);
        scene.objects.back().visible = false;
        scene.environment = NoEnvironment{};
        before = scene;
    }
    Emitter& large() { return std::get<Emitter>(scene.materials[0].material); }
    Principled& small() { return std::get<Principled>(scene.materials[1].material); }
    Emitter& spare() { return std::get<Emitter>(scene.materials[2].material); }
    Diffuse& clay() { return std::get<Diffuse>(scene.materials[3].material); }
    void only_the_large_lamp() { before.objects[1].visible = scene.objects[1].visible = false; }
    void only_the_sky(const Environment& sky) {
        for (Object& object : scene.objects) object.visible = false;
        scene.environment = sky;
        before = scene;
    }
    template <typename E>
    E& sky() {
        return std::get<E>(scene.environment);
    }
    std::optional<Vec3d> factor() {
        const auto found = light_factor(before, scene);
        const SceneChanges changes = diff(before, scene);
        EXPECT_EQ(changes.light, found);
        EXPECT_EQ(changes.restarts(), !found.has_value());
        EXPECT_TRUE(changes.any());
        return found;
    }

    Scene scene = empty_scene(8, 8), before;
};

TEST_F(LightFactor, TheOnlyLamp) {
    only_the_large_lamp();
    large().radiance.value = Color(2, 6, 0);
    EXPECT_EQ(factor(), Vec3d(0.5, 3, 1)) << "no light in blue, before or after";
    large().radiance.value = Color(2, 0, 0);
    EXPECT_EQ(factor(), Vec3d(0.5, 0, 1));
    large().radiance.value = Color(0);
    EXPECT_EQ(factor(), Vec3d(0, 0, 1)) << "switched off";
    large().radiance.value = Color(4, 2, 1);
    EXPECT_EQ(factor(), kNone) << "blue has come from nowhere";
}

TEST_F(LightFactor, ALampThatGivesOffOtherLightInAnotherWay) {
    only_the_large_lamp();
    large().two_sided = true;
    EXPECT_EQ(factor(), kNone);
    large() = std::get<Emitter>(before.materials[0].material);
    large().radiance.texture = std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "white"});
    EXPECT_EQ(factor(), kNone);
    before = scene;
    large().radiance.value *= 3.0f;
    EXPECT_EQ(factor(), Vec3d(3, 3, 1)) << "in proportion to its texture";
    scene.materials[0].material = Diffuse{};
    EXPECT_EQ(factor(), kNone);
}

TEST_F(LightFactor, ColourAndStrengthOfASurfaceThatGlows) {
    before.objects[0].visible = scene.objects[0].visible = false;
    small().emissive_strength = 2;
    small().emissive.value = Color(1, 1, 0);
    EXPECT_EQ(factor(), Vec3d(0.5, 1, 1));
    small().base_color.value = Color(0.5f);
    EXPECT_EQ(factor(), kNone);
}

TEST_F(LightFactor, AllLampsTogether) {
    large().radiance.value *= 3.0f;
    EXPECT_EQ(factor(), kNone) << "one of two";
    small().emissive_strength *= 3;
    EXPECT_EQ(factor(), Vec3d(3, 3, 1));
    small().emissive.value.y *= 1.001f;
    EXPECT_EQ(factor(), kNone);
    clay().albedo.value = Color(0.1f);
    EXPECT_EQ(factor(), kNone);
}

TEST_F(LightFactor, FactorsThatDifferByRoundingAlone) {
    for (const float k : {0.1f, 0.7f, 1.0f / 3, 7.7f}) {
        scene = before;
        large().radiance.value *= k;
        small().emissive.value *= k;
        const auto found = factor();
        ASSERT_TRUE(found) << k;
        EXPECT_NEAR(found->x / double{k}, 1, 1e-7);
        EXPECT_NEAR(found->y / double{k}, 1, 1e-7);
    }
}

TEST_F(LightFactor, WhatNothingVisibleHasDoesNotCount) {
    spare().radiance.value = Color(1, 2, 3);
    EXPECT_EQ(factor(), Vec3d(1));
    add_material(scene, Emitter{});
    EXPECT_EQ(factor(), Vec3d(1)) << "nor does a new material";
    scene.materials.erase(scene.materials.begin() + 2);
    EXPECT_EQ(factor(), Vec3d(1));
    // An object that is visible itself, but not what it is in.
    before.objects[0].shape = scene.objects[0].shape = ObjectList{};
    before.objects[0].visible = scene.objects[0].visible = false;
    before.objects[1].parent = scene.objects[1].parent = scene.objects[0].id;
    small().emissive_strength = 1;
    EXPECT_EQ(factor(), Vec3d(1));
    before.objects[0].visible = scene.objects[0].visible = true;
    EXPECT_EQ(factor(), Vec3d(0.125, 0.125, 1));
}

TEST_F(LightFactor, MaterialsOfAFile) {
    only_the_large_lamp();
    const Gltf gltf{"a.glb", std::make_shared<GltfGeometry>(), {scene.materials[1].id}};
    before.objects[2].shape = scene.objects[2].shape = gltf;
    before.objects[2].material = scene.objects[2].material = {};
    large().radiance.value *= 2.0f;
    EXPECT_EQ(factor(), kNone);
    small().emissive_strength *= 2;
    EXPECT_EQ(factor(), Vec3d(2, 2, 1));
}

TEST_F(LightFactor, Skies) {
    only_the_sky(ConstantEnvironment{Color(0.5f)});
    sky<ConstantEnvironment>().radiance = Color(1, 2, 0.25f);
    EXPECT_EQ(factor(), Vec3d(2, 4, 0.5));
    only_the_sky(GradientEnvironment{Color(0, 1, 1), Color(0, 0, 2)});
    sky<GradientEnvironment>().top = Color(0, 0, 3);
    EXPECT_EQ(factor(), kNone);
    sky<GradientEnvironment>().bottom = Color(0, 7, 1.5f);
    EXPECT_EQ(factor(), Vec3d(1, 7, 1.5)) << "green from one end, blue from both";
    only_the_sky(ImageEnvironment{"sky", std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "sky"})});
    sky<ImageEnvironment>().scale = 5;
    EXPECT_EQ(factor(), Vec3d(5));
    sky<ImageEnvironment>().rotation = 5;
    EXPECT_EQ(factor(), kNone);
    sky<ImageEnvironment>().rotation = 0;
    sky<ImageEnvironment>().image = std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "sky"});
    EXPECT_EQ(factor(), kNone);
    scene.environment = ConstantEnvironment{};
    EXPECT_EQ(factor(), kNone);
}

TEST_F(LightFactor, SkyAndLampTogether) {
    only_the_large_lamp();
    before.environment = scene.environment = ConstantEnvironment{Color(0.5f)};
    large().radiance.value *= 2.0f;
    EXPECT_EQ(factor(), kNone);
    sky<ConstantEnvironment>().radiance = Color(1, 1, 9);
    EXPECT_EQ(factor(), Vec3d(2, 2, 18)) << "the lamp has no blue";
}

TEST_F(LightFactor, FarFromWhatFloatsHoldWellNothingIsScaled) {
    only_the_large_lamp();
    for (const float dark : {1e-13f, 1e-30f, std::numeric_limits<float>::denorm_min()}) {
        large().radiance.value = Color(dark);
        EXPECT_EQ(factor(), kNone) << dark;
        std::swap(scene, before);
        EXPECT_EQ(factor(), kNone) << dark;
        std::swap(scene, before);
    }
    for (const float bad : {1e13f, -4.0f, INFINITY, NAN}) {
        large().radiance.value = Color(bad, 2, 0);
        EXPECT_EQ(factor(), kNone) << bad;
    }
    large().radiance.value = Color(-1);
    before = scene;
    spare().two_sided = true;
    EXPECT_EQ(factor(), Vec3d(1)) << "what does not change may be anything";
}

}  // namespace
}  // namespace rayuela
