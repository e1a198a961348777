#include "core/accel/kd_builder.h"

#include "core/accel/kd_cut.h"
#include "core/accel/parallel.h"

#include <algorithm>
#include <utility>

namespace rayuela {
namespace {

/// Nodes with more references than this are built as tasks of their own. A constant, so that the tree is the same for
/// any number of threads.
constexpr std::size_t kTaskReferences = 8192;

/// What is known of a node before its references are looked at.
struct NodeTask {
    Bounds3 cell;
    int depth = 0;
    std::uint64_t duplicates_left = 0;                 ///< References that cuts below may add.
    std::uint64_t nodes_left = KdNode::kMaxNodes - 1;  ///< That may stand below.
};

/// A tree of its own: nodes[0] is its root, indices count from its own beginning.
struct Subtree {
    std::vector<KdNode> nodes{KdNode()};
    std::vector<std::uint32_t> references;
};

using References = std::vector<KdReference>;

bool is_usable(const Bounds3& b) {
    return !b.empty() && is_finite(b.lo) && is_finite(b.hi);
}

/// One inner node over two subtrees.
Subtree join(int axis, float plane, Subtree&& below, Subtree&& above) {
    Subtree tree = {{KdNode::inner(axis, plane, 1), KdNode(), KdNode()}, std::move(below.references)};
    tree.nodes.reserve(below.nodes.size() + above.nodes.size() + 1);
    const auto first_reference = static_cast<std::uint32_t>(tree.references.size());
    tree.references.insert(tree.references.end(), above.references.begin(), above.references.end());
    const auto append = [&](const Subtree& part, std::size_t root_slot, std::uint32_t reference_offset) {
        // The root moves to its slot; node i >= 1 moves to the end.
        const auto offset = static_cast<std::uint32_t>(tree.nodes.size()) - 1;
        const auto moved = [&](const KdNode& node) {
            return node.is_leaf() ? KdNode::leaf(node.first() + reference_offset, node.count())
                                  : KdNode::inner(node.axis(), node.split(), node.children() + offset);
        };
        tree.nodes[root_slot] = moved(part.nodes[0]);
        for (std::size_t i = 1; i < part.nodes.size(); ++i) tree.nodes.push_back(moved(part.nodes[i]));
    };
    append(below, 1, 0);
    append(above, 2, first_reference);
    return tree;
}

class Builder {
public:
    Builder(const KdBuildInput& input, BuildControl& control) : input_(input), control_(control) {}

    /// Large nodes: each half a task.
    Subtree build_task(References references, const NodeTask& task) {
        Subtree tree;
        if (control_.cancelled) return tree;
        if (references.size() <= kTaskReferences) {
            build_node(tree, 0, references, 0, task);
            return tree;
        }
        const auto cut = choose_cut(references, task);
        if (!cut) {
            make_leaf(tree, 0, references);
            return tree;
        }
        References below;
        below.reserve(references.size() / 2);
        const std::size_t above = partition(references, 0, references.size(), *cut, below);
        const auto [task_below, task_above] = child_tasks(task, *cut, references.size(), below.size(), above);
        references.resize(above);

        Subtree tree_below, tree_above;
        fork_join([&, task_below = task_below] { tree_below = build_task(std::move(below), task_below); },
                  [&, task_above = task_above] { tree_above = build_task(std::move(references), task_above); });
        if (control_.cancelled) return tree;
        return join(cut->axis, cut->plane, std::move(tree_below), std::move(tree_above));
    }

private:
    /// The node's references are stack[begin..]; they are consumed. Children take turns on the same stack.
    void build_node(Subtree& tree, std::uint32_t slot, References& stack, std::size_t begin, const NodeTask& task) {
        if (control_.cancelled) return;
        const std::size_t end = stack.size();
        const auto cut = choose_cut(std::span(stack).subspan(begin), task);
        if (!cut) {
            make_leaf(tree, slot, std::span(stack).subspan(begin));
            stack.resize(begin);
            return;
        }
        const std::size_t above = partition(stack, begin, end, *cut, stack);
        const auto [task_below, task_above] = child_tasks(task, *cut, end - begin, stack.size() - end, above);
        const auto children = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[slot] = KdNode::inner(cut->axis, cut->plane, children);
        tree.nodes.resize(tree.nodes.size() + 2);
        build_node(tree, children, stack, end, task_below);
        stack.resize(begin + above);
        build_node(tree, children + 1, stack, begin, task_above);
    }

    void make_leaf(Subtree& tree, std::uint32_t slot, std::span<const KdReference> references) {
        std::uint64_t owned = 0;
        tree.nodes[slot] = KdNode::leaf(static_cast<std::uint32_t>(tree.references.size()),
                                        static_cast<std::uint32_t>(references.size()));
        for (const KdReference& reference : references) {
            tree.references.push_back(reference.primitive);
            owned += reference.owned ? 1 : 0;
        }
        control_.done.fetch_add(owned, std::memory_order_relaxed);
    }

    std::optional<KdCut> choose_cut(std::span<const KdReference> references, const NodeTask& task) const {
        if (task.depth >= kKdMaxDepth || task.nodes_left < 2 || references.empty()) return {};
        const auto cut = input_.split == KdSplit::median ? median_cut(references, task) : sah_cut(references, task);
        return cut && cut->duplicates <= task.duplicates_left ? cut : std::nullopt;
    }

    std::optional<KdCut> sah_cut(std::span<const KdReference> references, const NodeTask& task) const {
        const auto n = references.size();
        if (n <= static_cast<std::size_t>(input_.leaf_size)) return {};
        const auto cut = find_sah_cut(references, task.cell, input_.step_cost);
        return cut && cut->cost < static_cast<double>(n) ? cut : std::nullopt;
    }

    std::optional<KdCut> median_cut(std::span<const KdReference> references, const NodeTask& task) const {
        const auto owned = std::count_if(references.begin(), references.end(), [](const auto& r) { return r.owned; });
        if (owned <= input_.leaf_size) return {};
        std::vector<std::uint32_t> scratch;
        return find_median_cut(references, task.cell, input_.bounds, scratch);
    }

    /// Moves stack[begin, end) apart: the parts above to stack[begin...], whose number is returned, the parts below to
    /// the end of `below`, which may be the same stack.
    std::size_t partition(References& stack, std::size_t begin, std::size_t end, const KdCut& cut,
                          References& below) const {
        std::size_t above_end = begin;
        for (std::size_t i = begin; i < end; ++i) {
            const KdReference reference = stack[i];
            if (input_.split == KdSplit::sah && reference.box.hi[cut.axis] <= cut.plane) {
                below.push_back(reference);
                continue;
            }
            if (input_.split == KdSplit::sah && reference.box.lo[cut.axis] >= cut.plane) {
                stack[above_end++] = reference;
                continue;
            }
            KdSides sides = split_reference(reference, input_.mesh, cut.axis, cut.plane);
            bool owned_below = !sides.below.empty();
            if (input_.split == KdSplit::median && reference.owned) {
                owned_below = owner_below(cut, reference.primitive, input_.bounds[reference.primitive]);
                keep_with_owner(sides, reference.box, cut, owned_below);
            }
            const bool owned = reference.owned;
            if (!sides.above.empty()) stack[above_end++] = {sides.above, reference.primitive, owned && !owned_below};
            if (!sides.below.empty()) below.push_back({sides.below, reference.primitive, owned && owned_below});
        }
        return above_end - begin;
    }

    /// The owner's side has the reference even where only the centre of the bounds lies there, not the triangle.
    static void keep_with_owner(KdSides& sides, const Bounds3& box, const KdCut& cut, bool owned_below) {
        Bounds3& owner = owned_below ? sides.below : sides.above;
        if (!owner.empty()) return;
        owner = box;
        const bool within_plane = box.lo[cut.axis] == cut.plane && box.hi[cut.axis] == cut.plane;
        if (within_plane) (owned_below ? sides.above : sides.below) = {};
    }

    static std::pair<NodeTask, NodeTask> child_tasks(const NodeTask& task, const KdCut& cut, std::size_t references,
                                                     std::size_t below, std::size_t above) {
        NodeTask task_below = task, task_above = task;
        task_below.cell.hi[cut.axis] = cut.plane;
        task_above.cell.lo[cut.axis] = cut.plane;
        task_below.depth = task_above.depth = task.depth + 1;
        const std::uint64_t both = below + above;
        const std::uint64_t added = both > references ? both - references : 0;
        const std::uint64_t left = task.duplicates_left - std::min(added, task.duplicates_left);
        task_below.duplicates_left = both == 0 ? 0 : left * below / both;
        task_above.duplicates_left = left - task_below.duplicates_left;
        const std::uint64_t nodes = task.nodes_left - 2;
        task_below.nodes_left = both == 0 ? 0 : nodes * below / both;
        task_above.nodes_left = nodes - task_below.nodes_left;
        return {task_below, task_above};
    }

    const KdBuildInput& input_;
    BuildControl& control_;
};

}  // namespace

std::optional<KdTree> build_kd_tree(const KdBuildInput& input, BuildControl& control) {
    constexpr std::uint64_t kDuplicates = 8, kAlwaysAllowed = 1'000'000;
    NodeTask root;
    References references;
    references.reserve(input.bounds.size());
    for (std::uint32_t i = 0; i < input.bounds.size(); ++i) {
        const Bounds3& box = input.bounds[i];
        if (!is_usable(box)) continue;
        references.push_back({box, i, true});
        root.cell.extend(box);
    }
    root.duplicates_left = std::max(kDuplicates * references.size(), kAlwaysAllowed);
    const std::uint64_t unusable = input.bounds.size() - references.size();
    control.done.fetch_add(unusable, std::memory_order_relaxed);

    KdTree tree;
    tree.bounds = root.cell;
    Subtree built = Builder(input, control).build_task(std::move(references), root);
    if (control.cancelled) return {};
    tree.nodes = std::move(built.nodes);
    for (KdNode& node : tree.nodes) {
        if (node.is_leaf()) continue;
        node.set_empty(tree.nodes[node.children()].is_empty_leaf(), tree.nodes[node.children() + 1].is_empty_leaf());
    }
    tree.references = std::move(built.references);
    return tree;
}

}  // namespace rayuela
