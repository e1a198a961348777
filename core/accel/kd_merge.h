#pragma once

#include "core/accel/kd_builder.h"

#include <functional>

namespace rayuela {

using LeafReferences = std::function<std::span<const std::uint32_t>(const KdNode&)>;

/// The tree for a leaf size that is not smaller than the one that `tree` was built for: the same cuts, but the leaves below
/// a node that holds at most leaf_size primitives made one. Median: node for node what build_kd_tree gives. Sah: nodes
/// there can have references more, to what a cut farther down shows not to reach them. Leaves list primitives in
/// ascending order. What stands apart is left out. Nothing when cancelled.
std::optional<KdTree> merge_leaves(const KdTree& tree, const LeafReferences& references_of, KdSplit split,
                                   int leaf_size, BuildControl& control);
/// The same of a tree as build_kd_tree makes it.
std::optional<KdTree> merge_leaves(const KdTree& tree, KdSplit split, int leaf_size, BuildControl& control);

}  // namespace rayuela
