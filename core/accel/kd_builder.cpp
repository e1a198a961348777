#include "core/accel/kd_builder.h"

#include "core/accel/kd_partition.h"
#include "core/accel/parallel.h"

#include <algorithm>
#include <memory>
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

/// Leaves new elements as the memory was: they are written before they are read.
struct UnsetAllocator : std::allocator<KdReference> {
    template <typename T>
    struct rebind {
        using other = UnsetAllocator;
    };
    void construct(KdReference*) const noexcept {}
    template <typename... Arguments>
    void construct(KdReference* at, Arguments&&... arguments) const {
        std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
};
using References = std::vector<KdReference, UnsetAllocator>;

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
            const std::size_t count = references.size();
            build_node(tree, 0, references, 0, count, task);
            return tree;
        }
        const auto cut = choose_cut(references, task);
        if (!cut) {
            make_leaf(tree, 0, references);
            return tree;
        }
        References below(references.size());
        const KdPartCounts parts = partition(references, *cut, below.data());
        const auto [task_below, task_above] = child_tasks(task, *cut, references.size(), parts);
        below.resize(parts.below);
        references.resize(parts.above);

        Subtree tree_below, tree_above;
        fork_join([&, task_below = task_below] { tree_below = build_task(std::move(below), task_below); },
                  [&, task_above = task_above] { tree_above = build_task(std::move(references), task_above); });
        if (control_.cancelled) return tree;
        return join(cut->axis, cut->plane, std::move(tree_below), std::move(tree_above));
    }

private:
    /// The node's references are the `count` from `begin`; they and what follows are overwritten. Children take turns on
    /// the same memory.
    void build_node(Subtree& tree, std::uint32_t slot, References& memory, std::size_t begin, std::size_t count,
                    const NodeTask& task) {
        if (control_.cancelled) return;
        const auto cut = choose_cut(std::span(memory).subspan(begin, count), task);
        if (!cut) {
            make_leaf(tree, slot, std::span(memory).subspan(begin, count));
            return;
        }
        const std::size_t end = begin + count;
        if (memory.size() < end + count) memory.resize(end + count);
        const KdPartCounts parts = partition(std::span(memory).subspan(begin, count), *cut, memory.data() + end);
        const auto [task_below, task_above] = child_tasks(task, *cut, count, parts);
        const auto children = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[slot] = KdNode::inner(cut->axis, cut->plane, children);
        tree.nodes.resize(tree.nodes.size() + 2);
        build_node(tree, children, memory, end, parts.below, task_below);
        build_node(tree, children + 1, memory, begin, parts.above, task_above);
    }

    void make_leaf(Subtree& tree, std::uint32_t slot, std::span<const KdReference> references) {
        std::uint64_t owned = 0;
        tree.nodes[slot] = KdNode::leaf(static_cast<std::uint32_t>(tree.references.size()),
                                        static_cast<std::uint32_t>(references.size()));
        for (const KdReference& reference : references) {
            tree.references.push_back(reference.primitive);
            owned += reference.owned;
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
        const auto owned =
            std::count_if(references.begin(), references.end(), [](const auto& r) { return r.owned != 0; });
        if (owned <= input_.leaf_size) return {};
        std::vector<std::uint32_t> scratch;
        return find_median_cut(references, task.cell, input_.bounds, scratch);
    }

    KdPartCounts partition(std::span<KdReference> references, const KdCut& cut, KdReference* below) const {
        return input_.split == KdSplit::sah ? partition_sah(references, input_.mesh, cut, below)
                                            : partition_median(references, input_.mesh, cut, input_.bounds, below);
    }

    static std::pair<NodeTask, NodeTask> child_tasks(const NodeTask& task, const KdCut& cut, std::size_t references,
                                                     const KdPartCounts& parts) {
        NodeTask task_below = task, task_above = task;
        task_below.cell.hi[cut.axis] = cut.plane;
        task_above.cell.lo[cut.axis] = cut.plane;
        task_below.depth = task_above.depth = task.depth + 1;
        const std::uint64_t both = parts.below + parts.above;
        const std::uint64_t added = both > references ? both - references : 0;
        const std::uint64_t left = task.duplicates_left - std::min(added, task.duplicates_left);
        task_below.duplicates_left = both == 0 ? 0 : left * parts.below / both;
        task_above.duplicates_left = left - task_below.duplicates_left;
        const std::uint64_t nodes = task.nodes_left - 2;
        task_below.nodes_left = both == 0 ? 0 : nodes * parts.below / both;
        task_above.nodes_left = nodes - task_below.nodes_left;
        return {task_below, task_above};
    }

    const KdBuildInput& input_;
    BuildControl& control_;
};

}  // namespace

bool fits_a_tree(const Bounds3& bounds) {
    return !bounds.empty() && is_finite(bounds.lo) && is_finite(bounds.hi);
}

std::optional<KdTree> build_kd_tree(const KdBuildInput& input, BuildControl& control) {
    constexpr std::uint64_t kDuplicates = 8, kAlwaysAllowed = 1'000'000;
    NodeTask root;
    References references;
    references.reserve(input.bounds.size());
    for (std::uint32_t i = 0; i < input.bounds.size(); ++i) {
        const Bounds3& box = input.bounds[i];
        if (!fits_a_tree(box)) continue;
        references.push_back({box, i, 1});
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
