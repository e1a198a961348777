#include "core/accel/kd_tree.h"

#include <algorithm>
#include <utility>

namespace rayuela {

AccelStats KdTree::stats() const {
    AccelStats stats;
    stats.nodes = nodes.size();
    stats.references = references.size();
    stats.memory_bytes = nodes.size() * sizeof(KdNode) + references.size() * sizeof(std::uint32_t);
    stats.leaves = apart != 0 ? 1 : 0;
    std::vector<std::pair<std::uint32_t, int>> open{{0u, 0}};
    while (!open.empty()) {
        const auto [index, depth] = open.back();
        open.pop_back();
        if (nodes[index].is_leaf()) {
            ++stats.leaves;
            stats.depth = std::max(stats.depth, depth);
        } else {
            open.emplace_back(nodes[index].children(), depth + 1);
            open.emplace_back(nodes[index].children() + 1, depth + 1);
        }
    }
    return stats;
}

}  // namespace rayuela
