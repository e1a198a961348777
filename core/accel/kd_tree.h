#pragma once

#include "core/accel/accelerator.h"

#include <bit>
#include <cstdint>
#include <vector>

namespace rayuela {

/// Inner node: a plane across an axis; its children stand side by side; it knows which of them are empty leaves, so that
/// no ray goes there. Leaf: a run of references. 8 bytes: a word (the plane, or the first reference) and data:
///     inner: axis (2 bits), below is empty (1), above is empty (1), index of the children (28)
///     leaf:  3 (2 bits), number of references (30)
class KdNode {
public:
    static constexpr std::uint32_t kMaxNodes = 1u << 28;
    static constexpr std::uint32_t kLeaf = 3, kAxisMask = 3, kEmptyShift = 2, kChildrenShift = 4, kCountShift = 2;

    static KdNode inner(int axis, float split, std::uint32_t children) {
        return {std::bit_cast<std::uint32_t>(split), children << kChildrenShift | static_cast<std::uint32_t>(axis)};
    }
    static KdNode leaf(std::uint32_t first, std::uint32_t count) { return {first, count << kCountShift | kLeaf}; }
    KdNode() : KdNode(leaf(0, 0)) {}

    bool is_leaf() const { return (data_ & kAxisMask) == kLeaf; }
    int axis() const { return static_cast<int>(data_ & kAxisMask); }
    float split() const { return std::bit_cast<float>(word_); }
    /// Index of the child below the plane; the one above it follows.
    std::uint32_t children() const { return data_ >> kChildrenShift; }
    /// Whether the child below (0) or above (1) the plane is an empty leaf.
    bool is_empty(std::uint32_t side) const { return (data_ >> (kEmptyShift + side) & 1) != 0; }
    void set_empty(bool below, bool above) {
        data_ |= (std::uint32_t{below} | std::uint32_t{above} << 1) << kEmptyShift;
    }
    /// Of the leaf's references.
    std::uint32_t first() const { return word_; }
    std::uint32_t count() const { return data_ >> kCountShift; }
    bool is_empty_leaf() const { return data_ == kLeaf; }

private:
    KdNode(std::uint32_t word, std::uint32_t data) : word_(word), data_(data) {}

    std::uint32_t word_, data_;
};

inline constexpr int kKdMaxDepth = 60;

/// The root is nodes[0]; it always exists. Children stand behind their parents. A primitive is referenced by every leaf whose cell its surface meets.
struct KdTree {
    std::vector<KdNode> nodes{KdNode()};
    std::vector<std::uint32_t> references;  ///< Primitives, leaf by leaf.
    Bounds3 bounds;                         ///< The root's cell.
    /// A leaf of primitives that stand apart, to be tested beside the tree; 0 where there are none.
    std::uint32_t apart = 0;
    std::uint64_t primitives = 0;  ///< That fit a tree.

    /// Counts of nodes, leaves, references and their memory, and the depth.
    AccelStats stats() const;
};

}  // namespace rayuela
