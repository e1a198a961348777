#pragma once

#include "core/accel/kd_builder.h"

#include <memory>

namespace rayuela {

/// The kd-tree of one mesh in its own space, shared by all its instances, with the triangles of each leaf side by side as
/// SIMD wants them. Immutable.
struct MeshTree {
    std::shared_ptr<const TriangleMesh> mesh;
    KdTree tree;
    /// For a leaf with `count` references from `first`: 10 runs of `count` floats from kRuns * first on: x, y, z of the three
    /// vertices, then the largest extent of the triangle along an axis. Reading up to kPadding floats too far is allowed.
    std::unique_ptr<float[]> leaf_data;
    AccelStats stats;

    static constexpr std::size_t kRuns = 10;
    static constexpr std::size_t kPadding = 64;
};

/// Null when cancelled.
std::shared_ptr<const MeshTree> build_mesh_tree(std::shared_ptr<const TriangleMesh> mesh, const AccelSettings& settings,
                                                BuildControl& control);

}  // namespace rayuela
