#include "core/accel/kd_merge.h"

#include "core/accel/kd_branch.h"
#include "core/accel/parallel.h"

#include <algorithm>

namespace rayuela {
namespace {

/// Subtrees at this depth are tasks of their own.
constexpr int kTaskDepth = 8;

struct LeafLimit {
    KdSplit split;
    std::size_t leaf_size;
};

/// What is copied.
struct Source {
    const KdTree& tree;
    const LeafReferences& append_references;
};

/// Copies a subtree from its leaves up: leaves are made one as soon as both stand at the end of the copy.
class SubtreeCopy {
public:
    SubtreeCopy(KdSubtree& to, LeafLimit limit) : to_(to), limit_(limit) {}

    /// `owned`: primitives of its own that a node of a median tree has; for sah a measure of progress.
    void copy(const Source& from, std::uint32_t index, std::uint32_t slot, std::uint64_t owned) {
        const KdNode& node = from.tree.nodes[index];
        if (node.is_leaf()) {
            const auto first = static_cast<std::uint32_t>(to_.references.size());
            from.append_references(node, to_.references);
            std::sort(to_.references.begin() + first, to_.references.end());
            to_.nodes[slot] = KdNode::leaf(first, node.count());
            return;
        }
        const auto children = static_cast<std::uint32_t>(to_.nodes.size());
        to_.nodes[slot] = KdNode::inner(node.axis(), node.split(), children);
        to_.nodes.resize(to_.nodes.size() + 2);
        copy(from, node.children(), children, owned / 2);
        copy(from, node.children() + 1, children + 1, owned - owned / 2);
        merge(slot, owned);
    }

    /// The children of the node, if they are leaves (which then are the last) and hold no more than one leaf should.
    void merge(std::uint32_t slot, std::uint64_t owned) {
        const std::uint32_t children = to_.nodes[slot].children();
        const KdNode below = to_.nodes[children], above = to_.nodes[children + 1];
        if (!below.is_leaf() || !above.is_leaf()) return;
        const bool sah = limit_.split == KdSplit::sah;
        if (sah ? std::max(below.count(), above.count()) > limit_.leaf_size : owned > limit_.leaf_size) return;
        merged_.resize(below.count() + above.count());
        const auto begin = to_.references.begin() + below.first(), middle = begin + below.count();
        const auto end = std::set_union(begin, middle, middle, to_.references.end(), merged_.begin());
        merged_.erase(end, merged_.end());
        if (sah && merged_.size() > limit_.leaf_size) return;
        std::ranges::copy(merged_, begin);
        to_.references.resize(below.first() + merged_.size());
        to_.nodes.resize(children);
        to_.nodes[slot] = KdNode::leaf(below.first(), static_cast<std::uint32_t>(merged_.size()));
    }

private:
    KdSubtree& to_;
    LeafLimit limit_;
    std::vector<std::uint32_t> merged_;
};

class LeafMerger {
public:
    LeafMerger(const Source& from, LeafLimit limit, BuildControl& control)
        : from_(from), limit_(limit), control_(control) {}

    KdBranch branch(std::uint32_t index, int depth, std::uint64_t owned) {
        KdBranch branch;
        if (control_.cancelled) return branch;
        const KdNode& node = from_.tree.nodes[index];
        if (node.is_leaf() || depth == kTaskDepth) {
            SubtreeCopy(branch.tree, limit_).copy(from_, index, 0, owned);
            control_.done.fetch_add(owned, std::memory_order_relaxed);
            return branch;
        }
        branch.axis = node.axis();
        branch.plane = node.split();
        const auto half = [&](std::uint32_t child, std::uint64_t of) {
            return std::make_unique<const KdBranch>(this->branch(child, depth + 1, of));
        };
        fork_join([&] { branch.below = half(node.children(), owned / 2); },
                  [&] { branch.above = half(node.children() + 1, owned - owned / 2); });
        merge(branch, owned);
        return branch;
    }

private:
    void merge(KdBranch& branch, std::uint64_t owned) const {
        if (branch.below->below || branch.above->below) return;
        const KdSubtree &below = branch.below->tree, &above = branch.above->tree;
        if (below.nodes.size() > 1 || above.nodes.size() > 1) return;
        KdSubtree pair;
        const auto middle = static_cast<std::uint32_t>(below.references.size());
        pair.nodes = {KdNode::inner(branch.axis, branch.plane, 1), below.nodes[0],
                      KdNode::leaf(middle, above.nodes[0].count())};
        pair.references = below.references;
        pair.references.insert(pair.references.end(), above.references.begin(), above.references.end());
        SubtreeCopy(pair, limit_).merge(0, owned);
        if (pair.nodes.size() > 1) return;
        branch.tree = std::move(pair);
        branch.below.reset();
        branch.above.reset();
    }

    Source from_;
    LeafLimit limit_;
    BuildControl& control_;
};

}  // namespace

std::optional<KdTree> merge_leaves(const KdTree& tree, const LeafReferences& append_references, KdSplit split,
                                   int leaf_size, BuildControl& control) {
    const LeafLimit limit{split, static_cast<std::size_t>(leaf_size)};
    const KdBranch merged = LeafMerger({tree, append_references}, limit, control).branch(0, 0, tree.primitives);
    if (control.cancelled) return {};
    return assemble(merged, tree.bounds, tree.primitives);
}

std::optional<KdTree> merge_leaves(const KdTree& tree, KdSplit split, int leaf_size, BuildControl& control) {
    const auto append_references = [&](const KdNode& leaf, std::vector<std::uint32_t>& to) {
        const auto begin = tree.references.begin() + leaf.first();
        to.insert(to.end(), begin, begin + leaf.count());
    };
    return merge_leaves(tree, append_references, split, leaf_size, control);
}

}  // namespace rayuela
