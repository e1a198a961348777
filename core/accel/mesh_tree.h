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
    /// Its references are empty: what a leaf holds stands in its blocks. KdNode::first of a leaf: the unit of leaf_data at
    /// which they begin.
    KdTree tree;
    UnsetVector<float> leaf_data;  ///< Blocks (leaf_blocks.h), and kRunPadding floats that kernels may read too far.
    Bounds3 bounds;                ///< Of all triangles that a ray can meet.
    AccelStats stats;
    KdSplit split = KdSplit::sah;
    int leaf_size = kMaxLeafSize;

    /// Where the blocks begin of a leaf with this KdNode::first.
    const float* blocks(std::size_t first) const { return leaf_data.data() + LeafBlock::kUnit * first; }
    /// The triangles of a leaf.
    void append_references(const KdNode& leaf, std::vector<std::uint32_t>& to) const;
    std::vector<std::uint32_t> references(const KdNode& leaf) const;
};

/// All triangles in one leaf, for those who test them in turn.
std::shared_ptr<const MeshTree> make_mesh_leaf(const std::shared_ptr<const TriangleMesh>& mesh);

/// Null when cancelled. What a tree of the same mesh for another leaf size has in common with this one is taken from
/// `known` (may be null), see KdBuildInput::known and merge_leaves.
std::shared_ptr<const MeshTree> build_mesh_tree(const std::shared_ptr<const TriangleMesh>& mesh,
                                                const AccelSettings& settings, BuildControl& control,
                                                const MeshTree* known = nullptr);

}  // namespace rayuela
