#pragma once

#include "core/accel/kd_builder.h"
#include "core/accel/leaf_blocks.h"
#include "core/accel/unset_vector.h"

#include <memory>

namespace rayuela {

/// The kd-tree of one mesh in its own space, shared by all its instances, with the triangles of each leaf side by side as
/// SIMD wants them. Immutable. Does not keep the mesh.
struct MeshTree {
    std::weak_ptr<const TriangleMesh> mesh;
    KdTree tree;                   ///< KdNode::first of a leaf: where its blocks begin.
    UnsetVector<float> leaf_data;  ///< Blocks (leaf_blocks.h), and kRunPadding floats that kernels may read too far.
    Bounds3 bounds;                ///< Of all triangles that a ray can meet.
    AccelStats stats;
    KdSplit split = KdSplit::sah;
    int leaf_size = kMaxLeafSize;

    LeafBlock first_block(const KdNode& leaf) const { return LeafBlock(leaf_data.data() + leaf.first()); }
    /// The triangles of a leaf.
    std::span<const std::uint32_t> references(const KdNode& leaf) const {
        if (leaf.count() == 0) return {};
        return std::span(tree.references).subspan(first_block(leaf).first_name(), leaf.count());
    }
};

/// All triangles in one leaf, for those who test them in turn.
std::shared_ptr<const MeshTree> make_mesh_leaf(const std::shared_ptr<const TriangleMesh>& mesh);

/// Null when cancelled. What a tree of the same mesh for another leaf size has in common with this one is taken from
/// `known` (may be null), see KdBuildInput::known and merge_leaves.
std::shared_ptr<const MeshTree> build_mesh_tree(const std::shared_ptr<const TriangleMesh>& mesh,
                                                const AccelSettings& settings, BuildControl& control,
                                                const MeshTree* known = nullptr);

}  // namespace rayuela
