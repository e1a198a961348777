#include "core/accel/accelerator.h"

#include "core/accel/list.h"

#include <algorithm>

namespace rayuela {

AccelStats& AccelStats::operator+=(const AccelStats& other) {
    build_seconds += other.build_seconds;
    primitives += other.primitives;
    references += other.references;
    nodes += other.nodes;
    leaves += other.leaves;
    memory_bytes += other.memory_bytes;
    depth = std::max(depth, other.depth);
    return *this;
}

std::shared_ptr<const Accelerator> Accelerator::build(std::vector<GeometryInstance> instances,
                                                      const AccelSettings& settings, const Accelerator* previous,
                                                      BuildControl& control) {
    (void)previous;
    if (control.cancelled) return nullptr;
    return std::make_shared<ListAccelerator>(std::move(instances), settings);
}

}  // namespace rayuela
