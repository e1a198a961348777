#pragma once

#include "core/accel/kd_builder.h"
#include "core/accel/unset_vector.h"

#include <memory>

namespace rayuela {

/// The kd-tree of one mesh in its own space, shared by all its instances, with the triangles of each leaf side by side as
/// SIMD wants them. Immutable. Does not keep the mesh.
struct MeshTree {
    std::weak_ptr<const TriangleMesh> mesh;
    KdTree tree;
    /// The runs (triangle_runs.h) of a leaf with references from `first` begin at kTriangleRuns * first.
    UnsetVector<float> leaf_data;
    AccelStats stats;
    KdSplit split = KdSplit::sah;
    int leaf_size = kMaxLeafSize;
};

/// All triangles in one leaf, for those who test them in turn.
std::shared_ptr<const MeshTree> make_mesh_leaf(const std::shared_ptr<const TriangleMesh>& mesh);

/// Null when cancelled. What a tree of the same mesh for another leaf size has in common with this one is taken from
/// `known` (may be null), see KdBuildInput::known and merge_leaves.
std::shared_ptr<const MeshTree> build_mesh_tree(const std::shared_ptr<const TriangleMesh>& mesh,
                                                const AccelSettings& settings, BuildControl& control,
                                                const MeshTree* known = nullptr);

}  // namespace rayuela
