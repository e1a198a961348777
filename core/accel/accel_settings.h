#pragma once

#include <cstdint>

namespace rayuela {

enum class AcceleratorKind : std::uint8_t { list, kd };

/// How a kd-tree chooses its cuts.
enum class KdSplit : std::uint8_t {
    median,  ///< The paper's: across the longest axis of the node's box, half of its primitives on each side.
    sah,     ///< Surface area heuristic (MacDonald & Booth 1990; Wald & Havran 2006).
};

inline constexpr int kMinLeafSize = 1;
inline constexpr int kMaxLeafSize = 1 << 20;

struct AccelSettings {
    AcceleratorKind kind = AcceleratorKind::kd;
    int leaf_size = 16;  ///< Primitives a leaf should hold at most, in [kMinLeafSize, kMaxLeafSize].
    KdSplit split = KdSplit::sah;
    bool few_objects = true;  ///< Few objects and large ones are tested in turn, without a tree. Not part of a scene.
    /// Drafts of trees will do at first (see deserves_draft). Of an Accelerator: some of its trees are drafts. Not part of a
    /// scene.
    bool draft = false;

    bool operator==(const AccelSettings&) const = default;
};

}  // namespace rayuela
