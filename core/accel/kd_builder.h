#pragma once

#include "core/accel/kd_tree.h"

#include <optional>
#include <span>

namespace rayuela {

/// Whether a tree can hold what has these bounds: not empty and finite.
bool fits_a_tree(const Bounds3& bounds);

struct KdBuildInput {
    std::span<const Bounds3> bounds;  ///< Of each primitive; those that do not fit a tree are left out.
    /// When set, the primitives are its triangles, and cut ones are bounded by what is left of them.
    const TriangleMesh* mesh = nullptr;
    KdSplit split = KdSplit::sah;
    int leaf_size = 16;
    float step_cost = 1;  ///< Of a step of traversal, in tests of one primitive (sah).
    /// When set, a tree over the same primitives, of the same split and step cost, for a leaf size that is not smaller: its
    /// cuts are not looked for again (sah). The result is the same.
    const KdTree* known = nullptr;
    int known_leaf_size = 0;
};

/// The tree does not depend on the number of threads. References stay below 9 times the primitives (or a million), so that a
/// leaf can hold more than leaf_size where the primitives overlap too much to be told apart. Nothing when cancelled.
std::optional<KdTree> build_kd_tree(const KdBuildInput& input, BuildControl& control);

}  // namespace rayuela
