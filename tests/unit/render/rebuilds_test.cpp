#include "core/accel/kd_accelerator.h"
#include "core/render/progressive_renderer.h"
#include "core/render/render_session.h"
#include "core/scene/scene_edit.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

/// What an edit rebuilds: counted in primitives that a build has taken in, and seen by what two versions share.
namespace rayuela {
namespace {

using namespace rayuela::testing;

std::shared_ptr<const Scene> share(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

struct Version {
    std::shared_ptr<const RenderScene> scene;
    std::uint64_t built = 0;  ///< Objects and triangles that went into trees.
};

Version first(const Scene& scene) {
    BuildControl control;
    return {RenderScene::update(nullptr, share(scene), all_changes(), control), control.total};
}

Version next(const Version& before, const Scene& scene) {
    BuildControl control;
    const SceneChanges changes = diff(before.scene->scene(), scene);
    return {RenderScene::update(before.scene.get(), share(scene), changes, control), control.total};
}

bool same_trees(const Version& a, const Version& b) {
    return &a.scene->accelerator() == &b.scene->accelerator();
}
bool same_lights(const Version& a, const Version& b) {
    return &a.scene->lights() == &b.scene->lights();
}
bool same_emission(const Version& a, const Version& b) {
    return a.scene->emission() == b.scene->emission();
}

/// The only mesh of mixed_scene: its tree, or null.
const MeshTree* torus_tree(const Version& version) {
    const auto& kd = dynamic_cast<const KdAccelerator&>(version.scene->accelerator());
    for (std::uint32_t i = 0; i < kd.instances().size(); ++i) {
        if (kd.mesh_tree(i)) return kd.mesh_tree(i);
    }
    return nullptr;
}

class Rebuilds : public ::testing::Test {
protected:
    Object& torus() { return scene.objects[5]; }
    Object& quad_lamp() { return scene.objects[6]; }
    template <typename M>
    M& material(std::size_t index) {
        return std::get<M>(scene.materials[index].material);
    }
    static constexpr std::size_t kClay = 0, kMirror = 2, kLamp = 5, kObjects = 8, kTriangles = 2 * 24 * 12;

    Scene scene = mixed_scene(32, 24);
    Version before = first(scene);
};

TEST_F(Rebuilds, TheFirstSceneBuildsEverything) {
    EXPECT_EQ(before.built, kObjects + kTriangles);
    ASSERT_NE(before.scene->emission(), nullptr) << "or the tests below say nothing";
}

TEST_F(Rebuilds, CameraAndSamplingRebuildNothing) {
    scene.camera.position.x += 1;
    scene.render.max_bounces = 3;
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, 0u);
    EXPECT_TRUE(same_trees(before, after) && same_lights(before, after) && same_emission(before, after));
}

TEST_F(Rebuilds, AColourRebuildsNothing) {
    material<Diffuse>(kClay).albedo.value = Color(0.1f);
    material<Metal>(kMirror).albedo.value = Color(0.1f);
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, 0u);
    EXPECT_TRUE(same_trees(before, after) && same_lights(before, after) && same_emission(before, after));
    EXPECT_EQ(std::get<Metal>(after.scene->material(1)).albedo.value, Color(0.1f)) << "the mirror, after the plane";
}

TEST_F(Rebuilds, AMovedObjectRebuildsTheTopLevel) {
    torus().transform.translate.x += 1;
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, kObjects);
    EXPECT_EQ(torus_tree(after), torus_tree(before));
    EXPECT_TRUE(same_lights(before, after) && same_emission(before, after)) << "it neither shines nor throws caustics";
}

TEST_F(Rebuilds, AMovedLampRebuildsTheLights) {
    quad_lamp().transform.translate.x += 1;
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, kObjects);
    EXPECT_FALSE(same_lights(before, after));
    EXPECT_FALSE(same_emission(before, after));
}

TEST_F(Rebuilds, TheColourOfALampRebuildsTheLights) {
    material<Emitter>(kLamp).radiance.value = Color(1);
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, 0u);
    EXPECT_TRUE(same_trees(before, after));
    EXPECT_FALSE(same_lights(before, after));
    EXPECT_FALSE(same_emission(before, after));
}

TEST_F(Rebuilds, AnotherChoiceOfLampsRebuildsTheLights) {
    scene.render.light_choice = LightChoice::uniform;
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, 0u);
    EXPECT_TRUE(same_trees(before, after));
    EXPECT_FALSE(same_lights(before, after));
    EXPECT_TRUE(same_lights(after, next(after, scene)));
}

/// A quad is numbered before a sphere that the scene lists before it: the lamps are the same, by other numbers.
TEST_F(Rebuilds, LampsThatAreNumberedAnewStayTheSame) {
    add_object(scene, Quad{}, scene.materials[kClay].id);
    const Version after = next(before, scene);
    EXPECT_FALSE(same_lights(before, after));
    EXPECT_FALSE(same_emission(before, after));
    const LightTable& renumbered = after.scene->lights();
    const auto fresh = first(scene).scene;
    for (std::uint32_t i = 0; i < after.scene->accelerator().instances().size(); ++i) {
        const Hit hit{.object = i, .primitive = 0};
        EXPECT_EQ(renumbered.light_of(hit), fresh->lights().light_of(hit)) << i;
        EXPECT_EQ(renumbered.light_of(hit) != kNone, after.scene->packed_material(i).emissive) << i;
    }
}

TEST_F(Rebuilds, AMovedMirrorTakesItsCausticsAlong) {
    scene.objects[1].transform.translate.x += 1;  // The glass.
    const Version after = next(before, scene);
    EXPECT_TRUE(same_lights(before, after));
    EXPECT_FALSE(same_emission(before, after));
}

TEST_F(Rebuilds, HiddenLampsGiveNoLight) {
    const auto lights_of = [&](const Scene& of) { return next(before, of).scene->lights().size(); };
    const std::size_t all = before.scene->lights().size();
    quad_lamp().visible = false;
    EXPECT_EQ(lights_of(scene), all - 1);
    quad_lamp().visible = true;
    const ObjectId list = add_object(scene, ObjectList{});
    std::rotate(scene.objects.begin(), scene.objects.end() - 1, scene.objects.end());  // Parents come first.
    scene.objects[7].parent = list;
    EXPECT_EQ(lights_of(scene), all);
    scene.objects[0].visible = false;
    EXPECT_EQ(lights_of(scene), all - 1) << "its list is hidden";
}

TEST_F(Rebuilds, WhatBeginsToGlowIsALight) {
    const MaterialId clay = scene.materials[kClay].id;
    scene.objects[3].material = clay;
    const Version dull = next(before, scene);
    scene.materials[kClay].material = Principled{.emissive = {Color(1), nullptr}};
    const Version glowing = next(dull, scene);
    EXPECT_EQ(glowing.built, 0u);
    EXPECT_EQ(glowing.scene->lights().size(), dull.scene->lights().size() + 6) << "the faces of a box";
    scene.materials[kClay].material = Diffuse{};
    EXPECT_EQ(next(glowing, scene).scene->lights().size(), dull.scene->lights().size());
}

TEST_F(Rebuilds, AnotherMaterialRebuildsWhatItMeans) {
    scene.objects[3].material = scene.materials[kLamp].id;
    const Version lamp = next(before, scene);
    EXPECT_EQ(lamp.built, 0u);
    EXPECT_FALSE(same_lights(before, lamp));
    scene.objects[3].material = scene.materials[kMirror].id;
    const Version mirror = next(lamp, scene);
    EXPECT_FALSE(same_lights(lamp, mirror));
    EXPECT_FALSE(same_emission(lamp, mirror));
    scene.objects[3].material = scene.materials[kClay].id;
    const Version clay = next(mirror, scene);
    EXPECT_TRUE(same_lights(mirror, clay));
    EXPECT_FALSE(same_emission(mirror, clay));
}

TEST_F(Rebuilds, AnEvenSkyRebuildsNothing) {
    scene.environment = ConstantEnvironment{Color(1)};
    const Version after = next(before, scene);
    EXPECT_EQ(after.built, 0u);
    EXPECT_TRUE(same_trees(before, after) && same_lights(before, after) && same_emission(before, after));
    EXPECT_EQ(after.scene->environment().radiance(Vec3(0, 1, 0)), Color(1));
    scene.environment = ImageEnvironment{"sky", std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "sky"})};
    const Version panorama = next(after, scene);
    EXPECT_EQ(panorama.built, 0u);
    EXPECT_EQ(panorama.scene->lights().size(), after.scene->lights().size() + 1);
    scene.environment = NoEnvironment{};
    EXPECT_EQ(next(panorama, scene).scene->lights().size(), after.scene->lights().size());
}

/// Moves a cut, as no build would have it.
float mark(const MeshTree& tree) {
    KdNode& root = const_cast<KdNode&>(tree.tree.nodes[0]);
    root = KdNode::inner(root.axis(), std::nextafter(root.split(), kInfinity), root.children());
    return root.split();
}

TEST_F(Rebuilds, TheLeafSizeMakesTreesFromThoseThatAreThere) {
    const float marked = mark(*torus_tree(before));
    for (const int leaf_size : {3, 4, 100}) {
        scene.render.accel.leaf_size = leaf_size;
        const Version after = next(before, scene);
        EXPECT_EQ(after.built, kObjects + kTriangles);
        EXPECT_NE(torus_tree(after), torus_tree(before));
        EXPECT_EQ(torus_tree(after)->leaf_size, leaf_size);
        EXPECT_EQ(torus_tree(after)->tree.nodes[0].split(), marked);
        EXPECT_EQ(&after.scene->surfaces(), &before.scene->surfaces());
        EXPECT_TRUE(same_lights(before, after) && same_emission(before, after));
        scene.render.max_samples += 7;
        EXPECT_EQ(next(after, scene).built, 0u);
    }
    scene.render.accel.split = KdSplit::median;
    EXPECT_NE(torus_tree(next(before, scene))->tree.nodes[0].split(), marked) << "built anew";
}

TEST_F(Rebuilds, HiddenObjectsAreNotBuiltAndComeBackAsTheyWere) {
    torus().visible = false;
    const Version built_hidden = first(scene);
    EXPECT_EQ(built_hidden.built, kObjects - 1);
    EXPECT_EQ(torus_tree(built_hidden), nullptr);

    const Version hidden = next(before, scene);
    EXPECT_EQ(hidden.built, kObjects - 1);
    EXPECT_EQ(torus_tree(hidden), nullptr);
    EXPECT_EQ(hidden.scene->accelerator().stats().memory_bytes, built_hidden.scene->accelerator().stats().memory_bytes);
    EXPECT_GT(hidden.scene->accelerator().stats().kept_bytes, 0u);
    EXPECT_EQ(built_hidden.scene->accelerator().stats().kept_bytes, 0u);
    scene.objects[0].transform.translate.y -= 1;
    const Version still_hidden = next(hidden, scene);
    torus().visible = true;
    const Version shown = next(still_hidden, scene);
    EXPECT_EQ(shown.built, kObjects);
    EXPECT_EQ(torus_tree(shown), torus_tree(before));
    EXPECT_EQ(shown.scene->accelerator().stats().kept_bytes, 0u);
}

TEST_F(Rebuilds, AHiddenObjectIsEditedForNothingUntilItIsShown) {
    torus().visible = false;
    const Version hidden = next(before, scene);
    torus().transform.translate.x = 2;
    torus().material = scene.materials[kClay].id;
    const Version edited = next(hidden, scene);
    EXPECT_TRUE(same_trees(hidden, edited));
    torus().visible = true;
    const Version shown = next(edited, scene);
    EXPECT_EQ(shown.built, kObjects);
    EXPECT_EQ(shown.scene->accelerator().instances()[3].to_world, torus().transform.affine());
    EXPECT_EQ(shown.scene->material(3), scene.materials[kClay].material);
}

TEST_F(Rebuilds, ADeletedMeshComesBackAsItWasOrIsForgotten) {
    const Scene whole = scene;
    const std::weak_ptr<const TriangleMesh> mesh = std::get<Mesh>(torus().shape).data;
    scene.objects.erase(scene.objects.begin() + 5);
    Version deleted = next(before, scene);
    EXPECT_EQ(torus_tree(next(deleted, whole)), torus_tree(before)) << "undone";

    before = {};
    const_cast<Scene&>(whole) = {};
    EXPECT_TRUE(mesh.expired()) << "a tree holds no mesh";
    scene.objects[0].transform.translate.y -= 1;
    EXPECT_EQ(next(deleted, scene).scene->accelerator().stats().kept_bytes, 0u);
}

/// A file that is opened again gives the same mesh, see AssetCache; objects and materials get new ids.
TEST_F(Rebuilds, AReopenedSceneKeepsTheTreesOfItsMeshes) {
    Scene reopened = mixed_scene(32, 24);
    for (Object& object : reopened.objects) object.id.value += 1000;
    reopened.objects[5].shape = torus().shape;
    reopened.next_id += 1000;
    const Version after = next(before, reopened);
    EXPECT_EQ(after.built, kObjects);
    EXPECT_EQ(torus_tree(after), torus_tree(before));
}

TEST_F(Rebuilds, TheRendererCountsWhatItRestarts) {
    ProgressiveRenderer renderer(false, 1);
    const auto restarts_after = [&](const Scene& edited) {
        BuildControl control;
        EXPECT_TRUE(renderer.take(share(edited), control));
        return renderer.statistics(SessionPhase::rendering).restarts;
    };
    EXPECT_EQ(restarts_after(scene), 1u);
    scene.render.accel.leaf_size = 3;
    EXPECT_EQ(restarts_after(scene), 1u) << "the image does not depend on trees";
    scene.render.max_samples = 7;
    scene.objects[2].name = "gilded";
    EXPECT_EQ(restarts_after(scene), 1u);
    material<Diffuse>(kClay).albedo.value = Color(0.1f);
    EXPECT_EQ(restarts_after(scene), 2u);
    torus().transform.translate.x += 1;
    EXPECT_EQ(restarts_after(scene), 3u);
    add_material(scene, Emitter{});
    EXPECT_EQ(restarts_after(scene), 3u) << "nothing visible has it";
}

/// A long build that the next edit makes pointless is broken off: its scene is never taken, so nothing restarts for it.
TEST(StaleBuilds, AreCancelledByTheNextEdit) {
    Scene small = mixed_scene(16, 12);
    small.render.max_samples = 1;
    Scene large = small;
    add_object(large, Mesh{"large", torus_mesh(1000, 700)}, large.materials[0].id);
    RenderSession session({.threads = 1, .interactive = false});
    session.submit(share(large));
    while (session.status().build_progress == 0) std::this_thread::yield();
    session.submit(share(small));
    const auto frame = session.wait({});
    EXPECT_EQ(frame->statistics.restarts, 1u) << "only the second scene was ever rendered";
    EXPECT_EQ(frame->scene->objects.size(), small.objects.size());
    EXPECT_EQ(frame->statistics.accel.primitives, 7u + 2 * 24 * 12);
}

TEST(StaleBuilds, AreFinishedWhereTheNextEditNeedsThem) {
    Scene scene = mixed_scene(16, 12);
    scene.render.max_samples = 1;
    add_object(scene, Mesh{"large", torus_mesh(400, 300)}, scene.materials[0].id);
    RenderSession session({.threads = 1, .interactive = false});
    session.submit(share(scene));
    while (session.status().build_progress == 0) std::this_thread::yield();
    scene.camera.position.x += 1;
    session.submit(share(scene));
    const auto frame = session.wait({});
    EXPECT_EQ(frame->statistics.restarts, 2u);
    EXPECT_EQ(frame->scene->camera, scene.camera);
}

}  // namespace
}  // namespace rayuela
