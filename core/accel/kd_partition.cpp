#include "core/accel/kd_partition.h"

namespace rayuela {
namespace {

/// The owner's side has the reference even where only the centre of the bounds lies there, not the triangle.
void keep_with_owner(KdSides& sides, const Bounds3& box, const KdCut& cut, bool owned_below) {
    Bounds3& owner = owned_below ? sides.below : sides.above;
    if (!owner.empty()) return;
    owner = box;
    const bool within_plane = box.lo[cut.axis] == cut.plane && box.hi[cut.axis] == cut.plane;
    if (within_plane) (owned_below ? sides.above : sides.below) = {};
}

/// Without a mesh only boxes are cut.
KdPartCounts split_boxes(std::span<const KdReference> references, const KdCut& cut, KdReference* below,
                         KdReference* above) {
    KdPartCounts parts;
    for (const KdReference reference : references) {
        const KdSides sides = split_reference(reference, nullptr, cut.axis, cut.plane);
        below[parts.below++] = {sides.below, reference.primitive, reference.owned};
        above[parts.above++] = {sides.above, reference.primitive, 0};
    }
    return parts;
}

}  // namespace

KdPartCounts partition_sah(std::span<KdReference> references, const TriangleMesh* mesh, const KdCut& cut,
                           KdReference* below) {
    // No branch that is hard to foresee: each reference is written to where any of the three kinds comes next, of which
    // only one advances. Those on both sides gather at the end of `below`, downwards.
    KdReference* const end = below + references.size();
    const auto axis = static_cast<std::size_t>(cut.axis);
    KdPartCounts parts;
    std::size_t both = 0;
    for (const KdReference& from : references) {
        const KdReference reference = from;
        const float* const box = &from.box.lo.x;
        const std::size_t ends_beyond = box[axis + 3] > cut.plane, begins_before = box[axis] < cut.plane;
        *(end - 1 - both) = reference;
        below[parts.below] = reference;
        references[parts.above] = reference;
        parts.below += 1 - ends_beyond;
        parts.above += ends_beyond & (1 - begins_before);
        both += ends_beyond & begins_before;
    }
    if (both == 0) return parts;
    const std::span<const KdReference> cut_ones(end - both, both);
    KdReference* const more_below = below + parts.below;
    KdReference* const more_above = references.data() + parts.above;
    const KdPartCounts more = mesh ? split_references(cut_ones, *mesh, cut.axis, cut.plane, more_below, more_above)
                                   : split_boxes(cut_ones, cut, more_below, more_above);
    return {parts.below + more.below, parts.above + more.above};
}

KdPartCounts partition_median(std::span<KdReference> references, const TriangleMesh* mesh, const KdCut& cut,
                              std::span<const Bounds3> bounds, KdReference* below) {
    KdPartCounts parts;
    for (const KdReference reference : references) {
        KdSides sides = split_reference(reference, mesh, cut.axis, cut.plane);
        bool owned_below = !sides.below.empty();
        if (reference.owned != 0) {
            owned_below = owner_below(cut, reference.primitive, bounds[reference.primitive]);
            keep_with_owner(sides, reference.box, cut, owned_below);
        }
        const bool owned = reference.owned != 0;
        if (!sides.above.empty()) references[parts.above++] = {sides.above, reference.primitive, owned && !owned_below};
        if (!sides.below.empty()) below[parts.below++] = {sides.below, reference.primitive, owned && owned_below};
    }
    return parts;
}

}  // namespace rayuela
