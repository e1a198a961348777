#pragma once

#include "core/accel/kd_builder.h"

#include <memory>

namespace rayuela {

/// The kd-tree of one mesh in its own space, shared by all its instances, with the triangles of each leaf side by side as
/// SIMD wants them. Immutable. Does not keep the mesh.
struct MeshTree {
    std::weak_ptr<const TriangleMesh> mesh;
    KdTree tree;
    /// The runs (triangle_runs.h) of a leaf with references from `first` begin at kTriangleRuns * first.
    std::vector<float> leaf_data;
    AccelStats stats;
};

/// All triangles in one leaf, for those who test them in turn.
std::shared_ptr<const MeshTree> make_mesh_leaf(const std::shared_ptr<const TriangleMesh>& mesh);

/// Null when cancelled.
std::shared_ptr<const MeshTree> build_mesh_tree(const std::shared_ptr<const TriangleMesh>& mesh,
                                                const AccelSettings& settings, BuildControl& control);

}  // namespace rayuela
