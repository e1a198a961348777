#include "core/accel/kd_accelerator.h"
#include "core/accel/kd_merge.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

/// Trees that are made from the tree for another leaf size, beside those that are built anew.
namespace rayuela::test {
namespace {

using TreePtr = std::shared_ptr<const MeshTree>;

TreePtr make(const MeshPtr& mesh, KdSplit split, int leaf_size, const TreePtr& known = nullptr) {
    BuildControl control;
    return build_mesh_tree(mesh, {.leaf_size = leaf_size, .split = split}, control, known.get());
}

/// To the last bit.
bool same(const MeshTree& a, const MeshTree& b) {
    return a.tree.nodes.size() == b.tree.nodes.size() &&
           std::memcmp(a.tree.nodes.data(), b.tree.nodes.data(), a.tree.nodes.size() * sizeof(KdNode)) == 0 &&
           a.tree.references == b.tree.references && a.leaf_data.size() == b.leaf_data.size() &&
           std::memcmp(a.leaf_data.data(), b.leaf_data.data(), a.leaf_data.size() * sizeof(float)) == 0 &&
           a.leaf_size == b.leaf_size && a.stats.depth == b.stats.depth && a.stats.leaves == b.stats.leaves &&
           a.split == b.split;
}

std::vector<std::uint32_t> references_of(const MeshTree& tree, const KdNode& leaf) {
    const auto references = tree.references(leaf);
    return {references.begin(), references.end()};
}

/// All below a node, in ascending order.
std::vector<std::uint32_t> primitives_below(const MeshTree& tree, std::uint32_t index) {
    const KdNode& node = tree.tree.nodes[index];
    if (node.is_leaf()) {
        auto primitives = references_of(tree, node);
        std::ranges::sort(primitives);
        return primitives;
    }
    const auto below = primitives_below(tree, node.children()), above = primitives_below(tree, node.children() + 1);
    std::vector<std::uint32_t> both;
    std::ranges::set_union(below, above, std::back_inserter(both));
    return both;
}

/// Two trees from their roots down to where the first ends.
class Prefix {
public:
    Prefix(const MeshTree& merged, const MeshTree& finer, std::size_t leaf_size)
        : merged_(merged), finer_(finer), leaf_size_(leaf_size) {
        walk(0, 0);
    }

    std::size_t leaves = 0;

private:
    void walk(std::uint32_t m, std::uint32_t f) {
        const KdNode &node = merged_.tree.nodes[m], &finer = finer_.tree.nodes[f];
        if (!node.is_leaf()) {
            ASSERT_FALSE(finer.is_leaf());
            const KdNode &below = merged_.tree.nodes[node.children()], &above = merged_.tree.nodes[node.children() + 1];
            if (below.is_leaf() && above.is_leaf()) {
                EXPECT_GT(primitives_below(merged_, m).size(), leaf_size_) << "all of this fits in a leaf";
            }
            EXPECT_EQ(node.axis(), finer.axis());
            EXPECT_EQ(node.split(), finer.split());
            walk(node.children(), finer.children());
            walk(node.children() + 1, finer.children() + 1);
            return;
        }
        ++leaves;
        EXPECT_EQ(references_of(merged_, node), primitives_below(finer_, f));
        EXPECT_TRUE(node.count() <= leaf_size_ || finer.is_leaf());
    }

    const MeshTree &merged_, &finer_;
    std::size_t leaf_size_;
};

MeshPtr fan(std::uint32_t count) {
    Random random(6);
    std::vector<Vec3> positions{Vec3(0, -1, 0), Vec3(0, 1, 0)};
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < count; ++i) {
        positions.push_back(random.direction());
        triangles.push_back({0, 1, i + 2});
    }
    return make_mesh(positions, triangles);
}

MeshPtr with_broken_triangles(const TriangleMesh& mesh) {
    auto positions = mesh.positions;
    positions[5].x = std::numeric_limits<float>::quiet_NaN();
    positions[17].z = kInfinity;
    return make_mesh(positions, mesh.triangles);
}

/// The triangles of the last, 14,160, are built by several tasks.
std::vector<MeshPtr> meshes() {
    Random random(1);
    const MeshPtr soup = make_soup(500, random);
    return {soup,
            with_broken_triangles(*soup),
            fan(300),
            make_grid(30, 0.3f),
            make_grid(20, 0),
            make_mesh({Vec3(0, 0, 0), Vec3(1, 0.2f, 0), Vec3(0, 1, 0.4f)}, std::vector<glm::uvec3>(50, {0, 1, 2})),
            make_mesh({Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}),
            make_mesh({}, {}),
            make_ball(60, 1, Vec3(0), 0.02f, 9)};
}

constexpr int kSizes[] = {1, 2, 3, 16, 64, kMaxLeafSize};

TEST(LeafSize, RaisedMergesWhatFitsInALeaf) {
    for (const MeshPtr& mesh : meshes()) {
        const TreePtr finest = make(mesh, KdSplit::sah, 1);
        TreePtr stepwise = finest;
        for (const int size : kSizes) {
            const TreePtr raised = make(mesh, KdSplit::sah, size, finest);
            const Prefix prefix(*raised, *finest, static_cast<std::size_t>(size));
            EXPECT_EQ(prefix.leaves + (raised->tree.apart != 0 ? 1 : 0), raised->stats.leaves);
            EXPECT_EQ(raised->tree.bounds.lo, finest->tree.bounds.lo);
            stepwise = make(mesh, KdSplit::sah, size, stepwise);
            EXPECT_TRUE(same(*stepwise, *raised)) << "in one step or many, to " << size;
        }
    }
}

/// A build counts references that a deeper cut would show to be nowhere in the cell.
TEST(LeafSize, RaisedEndsWhereABuildDoesOrAbove) {
    for (const MeshPtr& mesh : meshes()) {
        for (const int size : kSizes) {
            const TreePtr anew = make(mesh, KdSplit::sah, size);
            const TreePtr raised = make(mesh, KdSplit::sah, size, make(mesh, KdSplit::sah, 1));
            EXPECT_LE(raised->tree.nodes.size(), anew->tree.nodes.size());
            EXPECT_GE(raised->tree.nodes.size(), 0.99 * static_cast<double>(anew->tree.nodes.size()));
            EXPECT_LE(raised->tree.references.size(), anew->tree.references.size());
            EXPECT_GE(raised->tree.references.size(), 0.99 * static_cast<double>(anew->tree.references.size()));
        }
    }
}

TEST(LeafSize, RaisedHasTheNodesOfABuildOfAMedianTree) {
    for (const MeshPtr& mesh : meshes()) {
        const TreePtr finest = make(mesh, KdSplit::median, 1);
        for (const int size : kSizes) {
            const TreePtr anew = make(mesh, KdSplit::median, size);
            const TreePtr raised = make(mesh, KdSplit::median, size, finest);
            ASSERT_EQ(raised->tree.nodes.size(), anew->tree.nodes.size());
            for (std::size_t i = 0; i < anew->tree.nodes.size(); ++i) {
                const KdNode &r = raised->tree.nodes[i], &a = anew->tree.nodes[i];
                ASSERT_EQ(r.is_leaf(), a.is_leaf());
                if (!a.is_leaf()) {
                    EXPECT_EQ(r.axis(), a.axis());
                    EXPECT_EQ(r.split(), a.split());
                    continue;
                }
                auto expected = references_of(*anew, a);
                std::ranges::sort(expected);
                EXPECT_TRUE(std::ranges::includes(expected, references_of(*raised, r)));
            }
        }
    }
}

TEST(LeafSize, LoweredIsWhatABuildGives) {
    for (const MeshPtr& mesh : meshes()) {
        for (const KdSplit split : {KdSplit::sah, KdSplit::median}) {
            for (const int to : {1, 5, 16}) {
                const TreePtr anew = make(mesh, split, to);
                for (const int from : kSizes) {
                    if (from <= to) continue;
                    const TreePtr built = make(mesh, split, from), raised = make(mesh, split, from, anew);
                    EXPECT_TRUE(same(*make(mesh, split, to, built), *anew)) << from << " to " << to;
                    EXPECT_TRUE(same(*make(mesh, split, to, raised), *anew)) << to << " to " << from << " and back";
                }
            }
        }
    }
}

/// A tree of which a cut has been moved, as no build would have it.
TreePtr marked(const MeshTree& tree) {
    auto copy = std::make_shared<MeshTree>(tree);
    const KdNode& root = tree.tree.nodes[0];
    copy->tree.nodes[0] = KdNode::inner(root.axis(), std::nextafter(root.split(), kInfinity), root.children());
    return copy;
}

TEST(LeafSize, TakesItsCutsFromTheTreeThatIsThere) {
    const MeshPtr mesh = make_grid(30, 0.3f);
    const TreePtr built = make(mesh, KdSplit::sah, 16), known = marked(*built);
    for (const int size : {4, 15, 17, 64})
        EXPECT_EQ(make(mesh, KdSplit::sah, size, known)->tree.nodes[0].split(), known->tree.nodes[0].split()) << size;
    const float median = make(mesh, KdSplit::median, 4)->tree.nodes[0].split();
    EXPECT_EQ(make(mesh, KdSplit::median, 4, known)->tree.nodes[0].split(), median) << "another split is built anew";
}

TEST(LeafSize, CancelledGivesNothing) {
    const MeshPtr mesh = make_ball(40, 1, Vec3(0), 0.02f, 9);
    const TreePtr known = make(mesh, KdSplit::sah, 16);
    for (const int size : {4, 64}) {
        BuildControl control;
        control.cancelled = true;
        EXPECT_EQ(build_mesh_tree(mesh, {.leaf_size = size}, control, known.get()), nullptr);
    }
}

TEST(LeafSize, ProgressEndsAtTheTotal) {
    Random random(2);
    const MeshPtr mesh = with_broken_triangles(*make_soup(3000, random));
    for (const KdSplit split : {KdSplit::sah, KdSplit::median}) {
        BuildControl first;
        const auto previous = Accelerator::build({{mesh, {}}}, {.leaf_size = 16, .split = split}, nullptr, first);
        for (const int size : {3, 16, 17, 200}) {
            BuildControl control;
            const auto next =
                Accelerator::build({{mesh, {}}}, {.leaf_size = size, .split = split}, previous.get(), control);
            ASSERT_NE(next, nullptr);
            EXPECT_EQ(control.total, size == 16 ? 1u : 3001u);
            EXPECT_EQ(control.done, control.total) << size;
        }
    }
}

/// Two objects of one mesh share its tree; a mesh out of sight keeps that of the leaf size it was last seen with.
TEST(LeafSize, EachMeshIsMadeFromItsOwnTree) {
    const MeshPtr a = make_grid(20, 0.3f), b = make_ball(8, 1, Vec3(0), 0.1f, 1);
    const auto built = [](std::vector<GeometryInstance> instances, int leaf_size, const Accelerator* previous) {
        BuildControl control;
        return std::dynamic_pointer_cast<const KdAccelerator>(
            Accelerator::build(std::move(instances), {.leaf_size = leaf_size}, previous, control));
    };
    const std::vector<GeometryInstance> all{{a, {}}, {a, {Mat3(1), Vec3(9, 0, 0)}}, {b, {}}}, some{{a, {}}};
    const auto first = built(all, 16, nullptr);
    const auto hidden = built(some, 64, first.get());
    EXPECT_EQ(hidden->stats().kept_bytes, first->mesh_tree(2)->stats.memory_bytes);
    const auto shown = built(all, 64, hidden.get());
    EXPECT_EQ(shown->mesh_tree(0), hidden->mesh_tree(0));
    EXPECT_EQ(shown->mesh_tree(0), shown->mesh_tree(1));
    EXPECT_EQ(shown->mesh_tree(2)->leaf_size, 64);
    EXPECT_EQ(shown->stats().kept_bytes, 0u);
    EXPECT_EQ(built(all, 16, hidden.get())->mesh_tree(2), first->mesh_tree(2)) << "as it was";
}

}  // namespace
}  // namespace rayuela::test
