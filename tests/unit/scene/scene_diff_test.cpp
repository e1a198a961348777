#include "core/scene/scene_diff.h"

#include "core/scene/scene_edit.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

/// A lamp (2) in a list (1), a ball of clay (3); materials lamp (4), clay (5) and an unused lamp (6).
Scene lit_scene() {
    Scene scene;
    scene.next_id = 7;
    scene.materials = {
        {MaterialId{4}, "lamp", Emitter{}}, {MaterialId{5}, "clay", Diffuse{}}, {MaterialId{6}, "spare", Emitter{}}};
    Object list, lamp, ball;
    list.id = ObjectId{1};
    list.shape = ObjectList{};
    lamp.id = ObjectId{2};
    lamp.parent = ObjectId{1};
    lamp.shape = Sphere{};
    lamp.material = MaterialId{4};
    ball.id = ObjectId{3};
    ball.shape = Sphere{};
    ball.material = MaterialId{5};
    scene.objects = {list, lamp, ball};
    return scene;
}

template <typename Change>
SceneChanges changes_by(const Change& change) {
    Scene after = lit_scene();
    change(after);
    EXPECT_TRUE(validate(after).empty()) << to_string(validate(after));
    const SceneChanges there = diff(lit_scene(), after), back = diff(after, lit_scene());
    EXPECT_EQ(there, back);
    return there;
}

TEST(SceneDiff, EqualScenesDoNotDiffer) {
    EXPECT_EQ(diff(lit_scene(), lit_scene()), SceneChanges{});
    EXPECT_FALSE(SceneChanges{}.any());
    EXPECT_TRUE(all_changes().restarts());
    EXPECT_TRUE(all_changes().accel);
}

TEST(SceneDiff, SettingsThatChangeNoImage) {
    const auto stops = changes_by([](Scene& s) { s.render.max_samples = 9, s.render.max_seconds = 3; });
    EXPECT_FALSE(stops.any());
    const auto names = changes_by([](Scene& s) { s.objects[0].name = "x", s.materials[0].name = "y", s.next_id = 99; });
    EXPECT_FALSE(names.any());
    const auto accel =
        changes_by([](Scene& s) { s.render.accel.leaf_size = 1, s.render.accel.kind = AcceleratorKind::list; });
    EXPECT_EQ(accel, SceneChanges{.accel = true});
    EXPECT_FALSE(accel.restarts());
}

TEST(SceneDiff, EachPartAlone) {
    EXPECT_EQ(changes_by([](Scene& s) { s.film.width = 9; }), SceneChanges{.film_size = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.film.filter = PixelFilter::tent; }), SceneChanges{.sampling = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.camera.vfov = 9; }), SceneChanges{.camera = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.render.max_bounces = 9; }), SceneChanges{.sampling = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.render.rr_start = 9; }), SceneChanges{.sampling = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.render.seed = 9; }), SceneChanges{.sampling = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.render.light_choice = LightChoice::power; }), SceneChanges{.sampling = true});
    EXPECT_EQ(changes_by([](Scene& s) { s.environment = ConstantEnvironment{}; }), SceneChanges{.environment = true});
}

TEST(SceneDiff, ObjectsAndMaterials) {
    const SceneChanges material{.materials = true}, geometry{.geometry = true}, assignment{.assignment = true};
    EXPECT_EQ(changes_by([](Scene& s) { s.materials[1].material = Metal{}; }), material);
    EXPECT_EQ(changes_by([](Scene& s) { std::get<Emitter>(s.materials[0].material).two_sided = true; }), material);
    EXPECT_EQ(changes_by([](Scene& s) { std::get<Sphere>(s.objects[2].shape).radius = 3; }), geometry);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects[2].visible = false; }), geometry);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects[0].transform.translate.x = 1; }), geometry);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects.pop_back(); }), geometry);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects.erase(s.objects.begin() + 1); }), geometry);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects[1].material = MaterialId{6}; }), assignment);
    EXPECT_EQ(changes_by([](Scene& s) { s.objects[2].material = MaterialId{}; }), assignment);
}

TEST(SceneDiff, WhatHappensToHiddenObjectsIsSeenLater) {
    Scene before = lit_scene();
    for (Object& object : before.objects) object.visible = false;
    Scene after = before;
    after.objects[0].transform.translate.x = 1;
    std::get<Sphere>(after.objects[1].shape).radius = 3;
    after.objects[2].material = MaterialId{4};
    EXPECT_FALSE(diff(before, after).any());
    after.objects[2].visible = true;
    EXPECT_EQ(diff(before, after), (SceneChanges{.geometry = true, .assignment = true}));
}

TEST(SceneDiff, MeshesAreWhatTheyHoldNotWhereTheyCameFrom) {
    Scene a = lit_scene();
    a.objects[2].shape = Mesh{"a.ply", std::make_shared<TriangleMesh>()};
    Scene b = a;
    std::get<Mesh>(b.objects[2].shape).file = "b.ply";
    EXPECT_FALSE(diff(a, b).any());
    std::get<Mesh>(b.objects[2].shape).data = std::make_shared<TriangleMesh>();
    EXPECT_EQ(diff(a, b), SceneChanges{.geometry = true});

    a.objects[2] =
        Object{ObjectId{3}, {}, "", Gltf{"a.glb", std::make_shared<GltfGeometry>(), {MaterialId{5}}}, {}, {}, true};
    b = a;
    std::get<Gltf>(b.objects[2].shape).materials = {MaterialId{4}};
    EXPECT_EQ(diff(a, b), (SceneChanges{.assignment = true}));
    b.objects[2].material = MaterialId{5};  // Replaces them all.
    EXPECT_EQ(diff(a, b), (SceneChanges{.assignment = true}));
}

}  // namespace
}  // namespace rayuela
