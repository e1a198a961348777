#include "core/accel/kd_branch.h"

#include "core/accel/large_pages.h"
#include "core/accel/parallel.h"

#include <algorithm>

namespace rayuela {
namespace {

/// Where a subtree goes: its root to a slot, all else to the places from two others on.
struct Piece {
    const KdSubtree* tree;
    std::uint32_t root_slot, first_node, first_reference;

    void copy_to(KdTree& whole) const {
        const std::vector<KdNode>& nodes = tree->nodes;
        const auto moved = [&](const KdNode& node) {
            if (node.is_leaf()) return KdNode::leaf(node.first() + first_reference, node.count());
            KdNode inner = KdNode::inner(node.axis(), node.split(), node.children() - 1 + first_node);
            inner.set_empty(nodes[node.children()].is_empty_leaf(), nodes[node.children() + 1].is_empty_leaf());
            return inner;
        };
        whole.nodes[root_slot] = moved(nodes[0]);
        std::transform(nodes.begin() + 1, nodes.end(), whole.nodes.begin() + first_node, moved);
        std::ranges::copy(tree->references, whole.references.begin() + first_reference);
    }
};

/// All places, found before anything is copied.
struct Layout {
    std::vector<Piece> pieces;
    std::vector<std::pair<std::uint32_t, KdNode>> inner;  ///< The nodes above them.
    std::uint32_t nodes = 1, references = 0;

    void place(const KdBranch& branch, std::uint32_t slot) {
        if (!branch.below) {
            pieces.push_back({&branch.tree, slot, nodes, references});
            nodes += static_cast<std::uint32_t>(branch.tree.nodes.size()) - 1;
            references += static_cast<std::uint32_t>(branch.tree.references.size());
            return;
        }
        const std::uint32_t children = nodes;
        nodes += 2;
        inner.emplace_back(slot, KdNode::inner(branch.axis, branch.plane, children));
        place(*branch.below, children);
        place(*branch.above, children + 1);
    }
};

}  // namespace

KdTree assemble(const KdBranch& root, const Bounds3& bounds, std::uint64_t primitives) {
    Layout layout;
    layout.place(root, 0);
    KdTree whole;
    whole.bounds = bounds;
    whole.primitives = primitives;
    whole.nodes.reserve(layout.nodes + 1);  // One more for a leaf of what stands apart.
    prefer_large_pages(whole.nodes.data(), whole.nodes.capacity() * sizeof(KdNode));
    fork_join([&] { whole.nodes.resize(layout.nodes); }, [&] { whole.references.resize(layout.references); });
    parallel_ranges(layout.pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) layout.pieces[i].copy_to(whole);
    });
    std::ranges::reverse(layout.inner);  // What lies below is there first.
    for (auto [slot, node] : layout.inner) {
        const KdNode* const children = &whole.nodes[node.children()];
        node.set_empty(children[0].is_empty_leaf(), children[1].is_empty_leaf());
        whole.nodes[slot] = node;
    }
    return whole;
}

}  // namespace rayuela
