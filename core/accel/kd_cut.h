#pragma once

#include "core/accel/kd_reference.h"

#include <optional>
#include <span>
#include <vector>

namespace rayuela {

/// A plane across a node's cell.
struct KdCut {
    int axis = 0;
    float plane = 0;
    double cost = 0;  ///< Expected cost of a ray in the node after the cut, in tests of one primitive (sah only).
    std::size_t duplicates = 0;  ///< At most so many references end up on both sides.
    float pivot = 0;             ///< See owner_below (median only).
    std::uint32_t pivot_primitive = kNone;
};

/// The paper's plane: across the longest axis of the cell, half of the owned primitives on each side by the centres of their
/// bounds (`bounds` of all primitives, `scratch` is overwritten); the next axis where the longest separates nothing.
/// Nothing where none does.
std::optional<KdCut> find_median_cut(std::span<const KdReference> references, const Bounds3& cell,
                                     std::span<const Bounds3> bounds, std::vector<std::uint32_t>& scratch);

/// Whether a median cut gives the primitive to the part below: its centre comes before the pivot, ties by number.
inline bool owner_below(const KdCut& cut, std::uint32_t primitive, const Bounds3& bounds) {
    const float center = bounds.center()[cut.axis];
    return center < cut.pivot || (center == cut.pivot && primitive < cut.pivot_primitive);
}

/// The cheapest plane by the surface area heuristic with a bonus for cutting off empty space (Wald & Havran, "On building
/// fast kd-trees for ray tracing", 2006). Of every plane at which a box begins or ends where the node holds at most 64; else of
/// 32 bins an axis over what it holds, then, up to 16,383, of such planes in the two bins beside the best. A flat box is below
/// the plane in which it lies and begins just before it. Nothing where no plane lies inside the cell.
std::optional<KdCut> find_sah_cut(std::span<const KdReference> references, const Bounds3& cell, float step_cost);

}  // namespace rayuela
