#include "core/accel/kd_accelerator.h"
#include "core/render/render_session.h"
#include "core/scene/scene_edit.h"
#include "tests/render_testing.h"
#include "tests/support/eventually.h"
#include "tests/support/hits.h"

#include <gtest/gtest.h>

#include <cstring>
#include <mutex>
#include <random>
#include <thread>

/// Large meshes are first shown in drafts of their trees.
namespace rayuela {
namespace {

using namespace rayuela::testing;
using test::eventually;
using namespace std::chrono_literals;

std::shared_ptr<const Scene> share(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

/// Just large enough for a draft; made once.
std::shared_ptr<const TriangleMesh> large_mesh() {
    static const auto mesh = torus_mesh(600, 220);
    EXPECT_GE(mesh->triangles.size(), kDraftTriangles);
    return mesh;
}

Scene large_scene(int width, int height) {
    Scene scene = mixed_scene(width, height);
    add_object(scene, Mesh{"large", large_mesh()}, scene.materials[0].id);
    return scene;
}

std::shared_ptr<const RenderScene> update(const Scene& scene, bool draft, const RenderScene* previous = nullptr) {
    BuildControl control;
    return RenderScene::update(previous, share(scene), previous ? diff(previous->scene(), scene) : all_changes(),
                               control, {}, draft);
}

const MeshTree& tree_of(const std::shared_ptr<const TriangleMesh>& mesh, const Accelerator& accelerator) {
    const auto& kd = dynamic_cast<const KdAccelerator&>(accelerator);
    const MeshTree* found = nullptr;
    for (std::uint32_t i = 0; i < kd.instances().size(); ++i) {
        const MeshTree* const tree = kd.mesh_tree(i);
        if (tree && tree->mesh.lock() == mesh) found = tree;
    }
    return *found;
}

const MeshTree& large_tree(const Accelerator& accelerator) {
    return tree_of(large_mesh(), accelerator);
}

/// Bits of all that rays read.
bool same_bits(const MeshTree& a, const MeshTree& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    return same(a.tree.nodes, b.tree.nodes) && same(a.tree.references, b.tree.references) &&
           same(a.leaf_data, b.leaf_data);
}

std::vector<Ray> rays_around(int count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(-3, 3);
    const auto point = [&] { return Vec3(number(random), number(random), number(random)); };
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) rays.push_back({.origin = point(), .direction = point()});
    return rays;
}

TEST(Drafts, BecomeTheTreesThatWereAskedFor) {
    const Scene scene = large_scene(16, 12);
    const auto eager = update(scene, false), drafted = update(scene, true);
    EXPECT_FALSE(eager->has_drafts());
    ASSERT_TRUE(drafted->has_drafts());
    EXPECT_EQ(large_tree(drafted->accelerator()).leaf_size, kDraftLeafSize);

    BuildControl control;
    const auto complete = drafted->without_drafts(control);
    const auto swapped = drafted->with_trees(*complete);
    EXPECT_FALSE(swapped->has_drafts());
    EXPECT_EQ(&large_tree(swapped->accelerator()), &large_tree(*complete));
    EXPECT_TRUE(same_bits(large_tree(*complete), large_tree(eager->accelerator())));
    EXPECT_EQ(&swapped->surfaces(), &drafted->surfaces());
    EXPECT_EQ(&swapped->lights(), &drafted->lights());
}

TEST(Drafts, GiveTheSameHits) {
    const Scene scene = large_scene(16, 12);
    const std::vector<Ray> rays = rays_around(20'000);
    const auto expected = test::trace(update(scene, false)->accelerator(), rays);
    const auto actual = test::trace(update(scene, true)->accelerator(), rays);
    int hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(test::identical(expected.hits[i], actual.hits[i])) << i;
        ASSERT_EQ(expected.blocked[i], actual.blocked[i]) << i;
        hits += expected.hits[i].valid() ? 1 : 0;
    }
    EXPECT_GT(hits, 1000);
}

TEST(Drafts, AreMadeOnlyWhereTheyArePromising) {
    EXPECT_FALSE(update(mixed_scene(16, 12), true)->has_drafts()) << "small meshes";
    Scene scene = large_scene(16, 12);
    scene.render.accel.kind = AcceleratorKind::list;
    EXPECT_FALSE(update(scene, true)->has_drafts());
    scene.render.accel = {.split = KdSplit::median};
    EXPECT_FALSE(update(scene, true)->has_drafts());
    scene.render.accel = {.leaf_size = kDraftLeafSize};
    EXPECT_FALSE(update(scene, true)->has_drafts());
}

TEST(Drafts, StayThroughEditsAndTakeTheTreesAfterThem) {
    Scene scene = large_scene(16, 12);
    const auto drafted = update(scene, true);
    BuildControl control;
    const auto complete = drafted->without_drafts(control);
    scene.objects[0].transform.translate.y -= 1;
    scene.render.accel.leaf_size = 8;
    const auto edited = update(scene, true, drafted.get());
    EXPECT_EQ(&large_tree(edited->accelerator()), &large_tree(drafted->accelerator()));
    EXPECT_TRUE(edited->has_drafts());
    scene.render.accel.leaf_size = 16;
    const auto back = update(scene, true, edited.get());
    const auto swapped = back->with_trees(*complete);
    EXPECT_EQ(&large_tree(swapped->accelerator()), &large_tree(*complete));
    EXPECT_TRUE(std::ranges::equal(swapped->accelerator().instances(), back->accelerator().instances()));

    scene.render.accel.leaf_size = 8;
    const auto known = update(scene, true, swapped.get());
    EXPECT_EQ(&large_tree(known->accelerator()), &large_tree(*complete)) << "a tree for another leaf size will do";
    EXPECT_TRUE(known->has_drafts());
}

TEST(Drafts, OfAMeshThatComesLaterStayWhenTheTreesOfTheOthersCome) {
    Scene scene = large_scene(16, 12);
    const auto first = update(scene, true);
    BuildControl control;
    const auto complete = first->without_drafts(control);
    const auto second_mesh = torus_mesh(500, 270);
    add_object(scene, Mesh{"second", second_mesh}, scene.materials[0].id, {.translate = Vec3(3, 0, 0)});
    const auto both = update(scene, true, first.get());
    const auto swapped = both->with_trees(*complete);
    EXPECT_TRUE(swapped->has_drafts());
    EXPECT_EQ(&large_tree(swapped->accelerator()), &large_tree(*complete));
    EXPECT_EQ(&tree_of(second_mesh, swapped->accelerator()), &tree_of(second_mesh, both->accelerator()));

    BuildControl rest;
    const auto all = swapped->without_drafts(rest);
    EXPECT_EQ(&large_tree(*all), &large_tree(*complete)) << "what is complete is not built again";
    EXPECT_LT(rest.total, large_mesh()->triangles.size() + second_mesh->triangles.size());
    EXPECT_TRUE(same_bits(tree_of(second_mesh, *all), tree_of(second_mesh, update(scene, false)->accelerator())));
}

/// Frames of an interactive session, and the image of the scene without drafts.
class DraftSession : public ::testing::Test {
protected:
    DraftSession() {
        scene.render.max_samples = 1;
        session.on_publish([this] {
            const std::lock_guard lock(mutex);
            frames.push_back(session.frame());
        });
    }
    std::shared_ptr<const Frame> finish() {
        EXPECT_TRUE(eventually([&] {
            const SessionStatus status = session.status();
            return status.taken == status.submitted && status.phase == SessionPhase::finished &&
                   !session.frame()->render_scene->has_drafts();
        }));
        return session.frame();
    }

    Scene scene = large_scene(320, 180);
    std::mutex mutex;
    std::vector<std::shared_ptr<const Frame>> frames;
    RenderSession session{{.threads = 2, .interactive = true}};
};

TEST_F(DraftSession, BeginsWithADraftAndGoesOnWithoutARestart) {
    session.submit(share(scene));
    const auto last = finish();
    EXPECT_TRUE(frames.front()->coarse && frames.front()->render_scene->has_drafts());
    EXPECT_EQ(last->statistics.restarts, 1u);
    EXPECT_EQ(large_tree(last->render_scene->accelerator()).leaf_size, scene.render.accel.leaf_size);
    RenderSession headless({.threads = 2, .interactive = false});
    headless.submit(share(scene));
    const auto expected = headless.wait({});
    EXPECT_FALSE(expected->render_scene->has_drafts());
    EXPECT_EQ(last->image.pixels, expected->image.pixels);
}

TEST_F(DraftSession, ShowsEditsBeforeTheTreesAreThere) {
    session.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return session.frame() != nullptr; }));
    const Camera first = scene.camera;
    // Of the view and of what stands there, so that the trees are put into another scene than they were built for.
    ASSERT_TRUE(eventually([&] {
        scene.camera.position.x += 0.01f;
        scene.objects[0].transform.translate.y -= 0.01f;
        session.submit(share(scene));
        std::this_thread::sleep_for(5ms);
        return !session.frame()->render_scene->has_drafts();
    }));
    const auto last = finish();
    EXPECT_EQ(last->scene->objects[0].transform, scene.objects[0].transform);
    EXPECT_TRUE(std::ranges::any_of(frames, [&](const auto& frame) {
        return frame->render_scene->has_drafts() && !(frame->scene->camera == first);
    }));
}

TEST_F(DraftSession, IsBrokenOffWhereTheTreesAreNoLongerAskedFor) {
    session.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return session.frame() != nullptr; }));
    scene.render.accel.leaf_size = 4;
    session.submit(share(scene));
    EXPECT_EQ(large_tree(finish()->render_scene->accelerator()).leaf_size, 4);
    EXPECT_EQ(session.frame()->statistics.restarts, 1u);

    scene.render.accel.leaf_size = 2;
    session.submit(share(scene));
    scene.objects.pop_back();
    session.submit(share(scene));
    EXPECT_EQ(finish()->statistics.accel.primitives, 7u + 2 * 24 * 12);
}

TEST_F(DraftSession, CanBeLeftAtAnyTime) {
    for (const auto pause : {0ms, 20ms, 60ms, 120ms}) {
        RenderSession left({.threads = 2, .interactive = true});
        left.submit(share(scene));
        std::this_thread::sleep_for(pause);
    }
}

TEST_F(DraftSession, WithoutDraftsTheFirstImageWaitsForTheTrees) {
    RenderSession eager({.threads = 2, .interactive = true, .drafts = false});
    eager.submit(share(scene));
    ASSERT_TRUE(eventually([&] { return eager.frame() != nullptr; }));
    EXPECT_FALSE(eager.frame()->render_scene->has_drafts());
}

}  // namespace
}  // namespace rayuela
