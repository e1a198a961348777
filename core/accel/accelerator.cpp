#include "core/accel/accelerator.h"

#include "core/accel/kd_accelerator.h"
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
    kept_bytes += other.kept_bytes;
    depth = std::max(depth, other.depth);
    return *this;
}

std::shared_ptr<const Accelerator> Accelerator::build(std::vector<GeometryInstance> instances,
                                                      const AccelSettings& settings, const Accelerator* previous,
                                                      BuildControl& control, const Accelerator* better) {
    if (control.cancelled) return nullptr;
    if (settings.kind == AcceleratorKind::list) {
        AccelSettings of_list = settings;
        of_list.draft = false;
        auto list = std::make_shared<ListAccelerator>(std::move(instances), of_list,
                                                      dynamic_cast<const ListAccelerator*>(previous));
        control.total += list->stats().primitives;
        control.done += list->stats().primitives;
        return list;
    }
    return KdAccelerator::build(std::move(instances), settings, dynamic_cast<const KdAccelerator*>(previous),
                                dynamic_cast<const KdAccelerator*>(better), control);
}

}  // namespace rayuela
