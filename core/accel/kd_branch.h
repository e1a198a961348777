#pragma once

#include "core/accel/kd_tree.h"

#include <memory>

namespace rayuela {

/// A tree of its own: nodes[0] is its root, indices count from its own beginning.
struct KdSubtree {
    std::vector<KdNode> nodes{KdNode()};
    std::vector<std::uint32_t> references;
};

/// What a task has built: a subtree, or an inner node over what two more tasks have built.
struct KdBranch {
    KdSubtree tree;  ///< Empty where there is more below.
    int axis = 0;
    float plane = 0;
    std::unique_ptr<const KdBranch> below, above;  ///< Both or none.
};

/// The tree of all that hangs on a branch: nodes and references copied once and in parallel, and the empty leaves made known
/// to the nodes above them. Children stand behind their parents.
KdTree assemble(const KdBranch& root, const Bounds3& bounds, std::uint64_t primitives);

}  // namespace rayuela
