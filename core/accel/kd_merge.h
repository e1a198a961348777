#pragma once

#include "core/accel/kd_builder.h"

#include <functional>

namespace rayuela {

/// Appends the primitives of a leaf.
using LeafReferences = std::function<void(const KdNode&, std::vector<std::uint32_t>&)>;

/// The tree for a leaf size that is not smaller than the one that `tree` was built for: the same cuts, but the leaves below
/// a node that holds at most leaf_size primitives made one. Median: node for node what build_kd_tree gives. Sah: nodes
/// there can have references more, to what a cut farther down shows not to reach them. Leaves list primitives in
/// ascending order. What stands apart is left out. Nothing when cancelled.
std::optional<KdTree> merge_leaves(const KdTree& tree, const LeafReferences& append_references, KdSplit split,
                                   int leaf_size, BuildControl& control);
/// The same of a tree as build_kd_tree makes it.
std::optional<KdTree> merge_leaves(const KdTree& tree, KdSplit split, int leaf_size, BuildControl& control);

}  // namespace rayuela
