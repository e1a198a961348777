#pragma once

#include "core/accel/kd_cut.h"
#include "core/accel/kd_split.h"

#include <span>

namespace rayuela {

/// Moves references to the sides of a cut by the surface area heuristic: the parts above to the beginning of
/// `references`, those below to `below`, which has room for all of them; returns how many. `mesh` as for split_reference.
KdPartCounts partition_sah(std::span<KdReference> references, const TriangleMesh* mesh, const KdCut& cut,
                           KdReference* below);

/// The same for a cut at the median, where the side of a primitive's centre owns it. `bounds`: of all primitives.
KdPartCounts partition_median(std::span<KdReference> references, const TriangleMesh* mesh, const KdCut& cut,
                              std::span<const Bounds3> bounds, KdReference* below);

}  // namespace rayuela
