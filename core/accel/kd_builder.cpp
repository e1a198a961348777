#include "core/accel/kd_builder.h"

#include "core/accel/kd_branch.h"
#include "core/accel/kd_partition.h"
#include "core/accel/parallel.h"
#include "core/accel/unset_vector.h"

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
    std::uint32_t known = kNone;                       ///< The same node of the known tree; kNone below its leaves.
    std::uint64_t duplicates_left = 0;                 ///< References that cuts below may add.
    std::uint64_t nodes_left = KdNode::kMaxNodes - 1;  ///< That may stand below.
};

struct ChildTasks {
    NodeTask below, above;
};

using References = UnsetVector<KdReference>;

/// Of all primitives that fit a tree, in their order. `cell` becomes what bounds them.
References all_references(std::span<const Bounds3> bounds, Bounds3& cell) {
    constexpr std::size_t kPart = 1 << 14;
    struct Part {
        std::size_t first = 0;  ///< At first, how many it has.
        Bounds3 bounds;
    };
    std::vector<Part> parts((bounds.size() + kPart - 1) / kPart);
    const auto each_of = [&](std::size_t part, const auto& body) {
        for (std::size_t i = part * kPart; i < std::min(bounds.size(), (part + 1) * kPart); ++i) {
            if (fits_a_tree(bounds[i])) body(i);
        }
    };
    const auto each_part = [&](const auto& body) {
        parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t part = begin; part < end; ++part) body(part);
        });
    };
    each_part([&](std::size_t part) {
        Part counted;
        each_of(part, [&](std::size_t i) {
            ++counted.first;
            counted.bounds.extend(bounds[i]);
        });
        parts[part] = counted;
    });
    std::size_t size = 0;
    for (Part& part : parts) {
        size += std::exchange(part.first, size);
        cell.extend(part.bounds);
    }
    References references(size);
    each_part([&](std::size_t part) {
        std::size_t at = parts[part].first;
        each_of(part, [&](std::size_t i) { references[at++] = {bounds[i], static_cast<std::uint32_t>(i), 1}; });
    });
    return references;
}

class Builder {
public:
    Builder(const KdBuildInput& input, BuildControl& control) : input_(input), control_(control) {}

    /// Large nodes: each half a task.
    KdBranch build_task(References references, const NodeTask& task) {
        KdBranch branch;
        if (control_.cancelled) return branch;
        if (references.size() <= kTaskReferences) {
            const std::size_t count = references.size();
            const std::uint64_t owned = count_owned(references);
            build_node(branch.tree, 0, references, 0, count, task);
            control_.done.fetch_add(owned, std::memory_order_relaxed);
            return branch;
        }
        const auto cut = choose_cut(references, task);
        if (!cut) {
            make_leaf(branch.tree, 0, references);
            control_.done.fetch_add(count_owned(references), std::memory_order_relaxed);
            return branch;
        }
        References below(references.size());
        const KdPartCounts parts = partition(references, *cut, below.data());
        const ChildTasks tasks = child_tasks(task, *cut, references.size(), parts);
        below.resize(parts.below);
        references.resize(parts.above);

        branch.axis = cut->axis;
        branch.plane = cut->plane;
        const auto build_half = [&](References half, const NodeTask& of) {
            return std::make_unique<const KdBranch>(build_task(std::move(half), of));
        };
        fork_join([&] { branch.below = build_half(std::move(below), tasks.below); },
                  [&] { branch.above = build_half(std::move(references), tasks.above); });
        return branch;
    }

private:
    /// The node's references are the `count` from `begin`; they and what follows are overwritten. Children take turns on
    /// the same memory.
    void build_node(KdSubtree& tree, std::uint32_t slot, References& memory, std::size_t begin, std::size_t count,
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
        const ChildTasks tasks = child_tasks(task, *cut, count, parts);
        const auto children = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[slot] = KdNode::inner(cut->axis, cut->plane, children);
        tree.nodes.resize(tree.nodes.size() + 2);
        build_node(tree, children, memory, end, parts.below, tasks.below);
        build_node(tree, children + 1, memory, begin, parts.above, tasks.above);
    }

    void make_leaf(KdSubtree& tree, std::uint32_t slot, std::span<const KdReference> references) {
        tree.nodes[slot] = KdNode::leaf(static_cast<std::uint32_t>(tree.references.size()),
                                        static_cast<std::uint32_t>(references.size()));
        for (const KdReference& reference : references) tree.references.push_back(reference.primitive);
    }

    static std::uint64_t count_owned(std::span<const KdReference> references) {
        std::uint64_t owned = 0;
        for (const KdReference& reference : references) owned += reference.owned;
        return owned;
    }

    // A cut is made where it is kept: a whole copied right after its parts were stored waits.
    std::optional<KdCut> choose_cut(std::span<const KdReference> references, const NodeTask& task) const {
        const bool may_be_cut = task.depth < kKdMaxDepth && task.nodes_left >= 2 && !references.empty();
        auto cut = !may_be_cut                          ? std::optional<KdCut>()
                   : input_.split == KdSplit::median    ? median_cut(references, task)
                   : knows_cut(references.size(), task) ? known_cut(references.size(), task)
                                                        : find_sah_cut(references, task.cell, input_.step_cost);
        if (cut && (cut->duplicates > task.duplicates_left || cut->cost >= static_cast<double>(references.size())))
            cut.reset();
        return cut;
    }

    const KdNode* known_node(const NodeTask& task) const {
        return task.known == kNone ? nullptr : &input_.known->nodes[task.known];
    }

    /// Whether it is known without looking at the `n` references which cut the node has, or that it has none (sah).
    bool knows_cut(std::size_t n, const NodeTask& task) const {
        const KdNode* const known = known_node(task);
        return n <= static_cast<std::size_t>(input_.leaf_size) ||
               (known && (!known->is_leaf() || known->count() > static_cast<std::size_t>(input_.known_leaf_size)));
    }
    std::optional<KdCut> known_cut(std::size_t n, const NodeTask& task) const {
        const KdNode* const known = known_node(task);
        if (n <= static_cast<std::size_t>(input_.leaf_size) || !known || known->is_leaf()) return {};
        return KdCut{.axis = known->axis(), .plane = known->split()};
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

    ChildTasks child_tasks(const NodeTask& task, const KdCut& cut, std::size_t references,
                           const KdPartCounts& parts) const {
        ChildTasks tasks{task, task};
        NodeTask &task_below = tasks.below, &task_above = tasks.above;
        const KdNode* const known = known_node(task);
        const bool cut_there = known && !known->is_leaf();
        task_below.known = cut_there ? known->children() : kNone;
        task_above.known = cut_there ? known->children() + 1 : kNone;
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
        return tasks;
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
    References references = all_references(input.bounds, root.cell);
    if (input.known && input.split == KdSplit::sah) root.known = 0;
    root.duplicates_left = std::max(kDuplicates * references.size(), kAlwaysAllowed);
    const std::uint64_t unusable = input.bounds.size() - references.size();
    control.done.fetch_add(unusable, std::memory_order_relaxed);

    const KdBranch built = Builder(input, control).build_task(std::move(references), root);
    if (control.cancelled) return {};
    return assemble(built, root.cell, input.bounds.size() - unusable);
}

}  // namespace rayuela
