#include "core/accel/kd_tree.h"

#include <algorithm>

namespace rayuela {

AccelStats KdTree::stats() const {
    AccelStats stats;
    stats.nodes = nodes.size();
    stats.references = references.size();
    stats.memory_bytes = nodes.size() * sizeof(KdNode) + references.size() * sizeof(std::uint32_t);
    std::vector<std::uint8_t> depth(nodes.size(), 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].is_leaf()) {
            ++stats.leaves;
            stats.depth = std::max<int>(stats.depth, depth[i]);
        } else {
            const std::uint32_t children = nodes[i].children();
            depth[children] = depth[children + 1] = static_cast<std::uint8_t>(depth[i] + 1);
        }
    }
    return stats;
}

}  // namespace rayuela
