#pragma once

#include "core/accel/accelerator.h"

#include <bit>
#include <cstdint>
#include <vector>

namespace rayuela {

/// Inner node: a plane across an axis; its children stand side by side. Leaf: a run of references. 8 bytes.
class KdNode {
public:
    static KdNode inner(int axis, float split, std::uint32_t children) {
        return {std::bit_cast<std::uint32_t>(split), children << 2 | static_cast<std::uint32_t>(axis)};
    }
    static KdNode leaf(std::uint32_t first, std::uint32_t count) { return {first, count << 2 | kLeaf}; }
    KdNode() : KdNode(leaf(0, 0)) {}

    bool is_leaf() const { return (data_ & 3u) == kLeaf; }
    int axis() const { return static_cast<int>(data_ & 3u); }
    float split() const { return std::bit_cast<float>(word_); }
    /// Index of the child below the plane; the one above it follows.
    std::uint32_t children() const { return data_ >> 2; }
    /// Of the leaf's references.
    std::uint32_t first() const { return word_; }
    std::uint32_t count() const { return data_ >> 2; }

private:
    static constexpr std::uint32_t kLeaf = 3;
    KdNode(std::uint32_t word, std::uint32_t data) : word_(word), data_(data) {}

    std::uint32_t word_, data_;
};

inline constexpr int kKdMaxDepth = 60;

/// The root is nodes[0]; it always exists. A primitive is referenced by every leaf whose cell its surface meets.
struct KdTree {
    std::vector<KdNode> nodes{KdNode()};
    std::vector<std::uint32_t> references;  ///< Primitives, leaf by leaf.
    Bounds3 bounds;                         ///< The root's cell.

    /// Counts of nodes, leaves, references and their memory, and the depth.
    AccelStats stats() const;
};

}  // namespace rayuela
