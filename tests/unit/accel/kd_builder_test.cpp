#include "core/accel/kd_builder.h"

#include "core/accel/mesh_tree.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <functional>
#include <set>
#include <thread>

namespace rayuela::test {
namespace {

std::vector<Bounds3> bounds_of(const TriangleMesh& mesh) {
    std::vector<Bounds3> bounds;
    for (const glm::uvec3& t : mesh.triangles) {
        Bounds3& box = bounds.emplace_back();
        for (int corner = 0; corner < 3; ++corner) box.extend(mesh.positions[t[corner]]);
    }
    return bounds;
}

KdTree build_tree(const TriangleMesh& mesh, KdSplit split, int leaf_size) {
    const auto bounds = bounds_of(mesh);
    BuildControl control;
    return *build_kd_tree({.bounds = bounds, .mesh = &mesh, .split = split, .leaf_size = leaf_size}, control);
}

struct Leaf {
    Bounds3 cell;
    std::vector<std::uint32_t> references;
    int depth;
};

std::vector<Leaf> leaves_of(const KdTree& tree) {
    std::vector<Leaf> leaves;
    const std::function<void(std::uint32_t, Bounds3, int)> walk = [&](std::uint32_t index, Bounds3 cell, int depth) {
        const KdNode& node = tree.nodes[index];
        if (node.is_leaf()) {
            const auto first = tree.references.begin() + node.first();
            leaves.push_back({cell, {first, first + node.count()}, depth});
            return;
        }
        EXPECT_GT(node.split(), cell.lo[node.axis()]);
        EXPECT_LT(node.split(), cell.hi[node.axis()]);
        Bounds3 below = cell, above = cell;
        below.hi[node.axis()] = above.lo[node.axis()] = node.split();
        walk(node.children(), below, depth + 1);
        walk(node.children() + 1, above, depth + 1);
    };
    walk(0, tree.bounds, 0);
    return leaves;
}

bool inside(const Bounds3& cell, const Vec3d& p, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] < cell.lo[axis] - tolerance || p[axis] > cell.hi[axis] + tolerance) return false;
    }
    return true;
}

TEST(KdBuilder, SixteenThousandTrianglesAtFiveHundredGiveThirtyTwoLeavesOfFiveHundred) {
    Random random(1);
    const MeshPtr ball = make_ball(64, 1, Vec3(0), 0.01f, 1);
    const std::vector<MeshPtr> meshes{
        make_soup(16000, random),
        make_mesh(ball->positions, {ball->triangles.begin(), ball->triangles.begin() + 16000}), make_grid(90, 0.2f)};
    for (const MeshPtr& mesh : meshes) {
        const MeshPtr cut = make_mesh(mesh->positions, {mesh->triangles.begin(), mesh->triangles.begin() + 16000});
        const auto bounds = bounds_of(*cut);
        const KdTree tree = build_tree(*cut, KdSplit::median, 500);
        const auto leaves = leaves_of(tree);
        EXPECT_EQ(leaves.size(), 32u);
        std::set<std::uint32_t> referenced;
        std::size_t owned_total = 0;
        for (const Leaf& leaf : leaves) {
            EXPECT_EQ(leaf.depth, 5);
            EXPECT_GE(leaf.references.size(), 500u);
            std::size_t strictly_inside = 0, touching = 0;
            for (const std::uint32_t primitive : leaf.references) {
                referenced.insert(primitive);
                const Vec3 center = bounds[primitive].center();
                touching += leaf.cell.contains(center) ? 1 : 0;
                strictly_inside +=
                    glm::all(glm::lessThan(leaf.cell.lo, center)) && glm::all(glm::lessThan(center, leaf.cell.hi));
            }
            EXPECT_LE(strictly_inside, 500u);
            EXPECT_GE(touching, 500u) << "a leaf refers to all that it owns";
            owned_total += strictly_inside;
        }
        EXPECT_EQ(referenced.size(), 16000u);
        EXPECT_LE(owned_total, 16000u);
    }
}

TEST(KdBuilder, MedianLeafCountIsThePowerOfTwoThatTheLeafSizeAsksFor) {
    Random random(2);
    const MeshPtr mesh = make_soup(1024, random);
    for (const int leaf_size : {1, 2, 4, 8, 16, 32, 64, 1024}) {
        const auto leaves = leaves_of(build_tree(*mesh, KdSplit::median, leaf_size));
        EXPECT_EQ(leaves.size(), static_cast<std::size_t>(1024 / leaf_size)) << leaf_size;
    }
}

TEST(KdBuilder, EveryLeafRefersToWhatItsCellMeets) {
    Random random(3);
    for (const MeshPtr& mesh : {make_soup(400, random), make_ball(10, 1, Vec3(0), 0.1f, 4), make_grid(12, 0)}) {
        for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
            for (const int leaf_size : {1, 3, 16}) {
                const auto leaves = leaves_of(build_tree(*mesh, split, leaf_size));
                for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
                    const glm::uvec3 t = mesh->triangles[i];
                    for (int sample = 0; sample < 20; ++sample) {
                        float u = random.uniform(), v = random.uniform();
                        if (sample < 3) u = sample == 1 ? 1.0f : 0.0f, v = sample == 2 ? 1.0f : 0.0f;
                        if (u + v > 1) u = 1 - u, v = 1 - v;
                        const Vec3d a(mesh->positions[t.x]), b(mesh->positions[t.y]), c(mesh->positions[t.z]);
                        const Vec3d p = a + double{u} * (b - a) + double{v} * (c - a);
                        const bool found = std::any_of(leaves.begin(), leaves.end(), [&](const Leaf& leaf) {
                            return inside(leaf.cell, p, 1e-14) &&
                                   std::find(leaf.references.begin(), leaf.references.end(), i) !=
                                       leaf.references.end();
                        });
                        ASSERT_TRUE(found) << "triangle " << i;
                    }
                }
            }
        }
    }
}

TEST(KdBuilder, SahReachesTheLeafSizeOnAnOrdinaryMesh) {
    const MeshPtr mesh = make_grid(40, 0.3f);
    // Six triangles meet in a vertex: below eight no cut pays.
    for (const std::size_t leaf_size : {8u, 16u, 64u}) {
        std::size_t largest = 0;
        for (const Leaf& leaf : leaves_of(build_tree(*mesh, KdSplit::sah, static_cast<int>(leaf_size)))) {
            largest = std::max(largest, leaf.references.size());
        }
        EXPECT_LE(largest, leaf_size);
        EXPECT_GT(largest, leaf_size / 2);
    }
}

TEST(KdBuilder, IdenticalTrianglesStayInOneLeaf) {
    std::vector<glm::uvec3> triangles(20000, glm::uvec3(0, 1, 2));
    const MeshPtr mesh = make_mesh({Vec3(0, 0, 0), Vec3(1, 0.2f, 0), Vec3(0, 1, 0.4f)}, triangles);
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        const KdTree tree = build_tree(*mesh, split, 1);
        EXPECT_LE(tree.references.size(), 40000u);
    }
}

/// A fan of long triangles through one edge cannot be told apart; memory stays bounded all the same.
TEST(KdBuilder, ReferencesAreBounded) {
    Random random(6);
    std::vector<Vec3> positions{Vec3(0, -1, 0), Vec3(0, 1, 0)};
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < 150000; ++i) {
        positions.push_back(random.direction());
        triangles.push_back({0, 1, i + 2});
    }
    const MeshPtr mesh = make_mesh(positions, triangles);
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        EXPECT_LE(build_tree(*mesh, split, 1).references.size(), 9u * triangles.size());
    }
}

TEST(KdBuilder, FlatLinePointAndHugeScenesBuild) {
    const auto line = [](const Vec3& step, int count) {
        std::vector<Vec3> positions;
        std::vector<glm::uvec3> triangles;
        for (int i = 0; i < count; ++i) {
            const Vec3 p = static_cast<float>(i) * step;
            const auto first = static_cast<std::uint32_t>(positions.size());
            positions.insert(positions.end(), {p, p + step, p + 0.5f * step});
            triangles.push_back({first, first + 1, first + 2});
        }
        return make_mesh(positions, triangles);
    };
    std::vector<MeshPtr> meshes{make_grid(20, 0), line(Vec3(1, 0, 0), 500), line(Vec3(0), 500), line(Vec3(1e-38f), 300),
                                line(Vec3(1e35f), 300)};
    Random random(8);
    std::vector<Vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < 900; ++i) {
        positions.push_back(random.in_cube(i % 5 == 0 ? 1e30f : 1e-3f));
        if (i % 3 == 2) triangles.push_back({i - 2, i - 1, i});
    }
    positions.push_back(Vec3(std::numeric_limits<float>::quiet_NaN()));
    positions.push_back(Vec3(kInfinity));
    triangles.push_back({900, 0, 1});
    triangles.push_back({901, 0, 1});
    meshes.push_back(make_mesh(positions, triangles));
    for (const MeshPtr& mesh : meshes) {
        for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
            const KdTree tree = build_tree(*mesh, split, 2);
            EXPECT_GE(tree.references.size(), mesh->triangles.size() - 2);
            EXPECT_LE(tree.stats().depth, kKdMaxDepth);
        }
    }
}

TEST(KdBuilder, TreeDoesNotDependOnTheNumberOfThreads) {
    const MeshPtr mesh = make_ball(100, 1, Vec3(0), 0.02f, 9);
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        KdTree trees[2];
        for (const int threads : {1, tbb::task_arena::automatic}) {
            tbb::task_arena arena(threads);
            arena.execute([&] { trees[threads == 1 ? 0 : 1] = build_tree(*mesh, split, 8); });
        }
        ASSERT_EQ(trees[0].nodes.size(), trees[1].nodes.size());
        EXPECT_EQ(trees[0].references, trees[1].references);
        EXPECT_EQ(std::memcmp(trees[0].nodes.data(), trees[1].nodes.data(), trees[0].nodes.size() * sizeof(KdNode)), 0);
    }
}

/// 40,000 triangles are built by several tasks.
TEST(KdBuilder, NodesOfAllTasksKnowTheirEmptyLeaves) {
    const MeshPtr mesh = make_ball(100, 1, Vec3(0), 0.02f, 11);
    const KdTree tree = build_tree(*mesh, KdSplit::sah, 4);
    std::vector<int> parents(tree.nodes.size());
    std::size_t empty = 0;
    for (const KdNode& node : tree.nodes) {
        if (node.is_leaf()) continue;
        for (const std::uint32_t side : {0u, 1u}) {
            ASSERT_LT(node.children() + side, tree.nodes.size());
            const KdNode& child = tree.nodes[node.children() + side];
            ASSERT_EQ(node.is_empty(side), child.is_empty_leaf());
            empty += child.is_empty_leaf() ? 1 : 0;
            ++parents[node.children() + side];
        }
    }
    EXPECT_GT(empty, 0u);
    EXPECT_EQ(parents[0], 0);
    EXPECT_EQ(std::count(parents.begin() + 1, parents.end(), 1), static_cast<std::ptrdiff_t>(parents.size() - 1));
    const std::set<std::uint32_t> referenced(tree.references.begin(), tree.references.end());
    EXPECT_EQ(referenced.size(), mesh->triangles.size());
}

TEST(KdBuilder, CancelStopsSoon) {
    const MeshPtr mesh = make_ball(300, 1, Vec3(0), 0.02f, 10);  // 360,000 triangles
    BuildControl control;
    std::clock_t stopped = 0;  // CPU time: what else the machine does must not count.
    std::thread canceller([&] {
        while (control.done == 0) std::this_thread::yield();
        stopped = std::clock();
        control.cancelled = true;
    });
    const auto accelerator = Accelerator::build({{mesh, {}}}, {}, nullptr, control);
    const std::clock_t returned = std::clock();
    canceller.join();
    EXPECT_EQ(accelerator, nullptr);
    EXPECT_LT(static_cast<double>(returned - stopped) / CLOCKS_PER_SEC, 0.25) << "of some 0.4";
}

TEST(KdBuilder, ProgressEndsAtTheTotal) {
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        BuildControl control;
        const auto kd = Accelerator::build(make_scene(3, 30, 3000), {.leaf_size = 4, .split = split}, nullptr, control);
        ASSERT_NE(kd, nullptr);
        EXPECT_GT(control.total, 3000u);
        EXPECT_EQ(control.done, control.total);
    }
}

}  // namespace
}  // namespace rayuela::test
