#pragma once

#include "core/accel/kd_reference.h"

#include <cstddef>
#include <span>

namespace rayuela {

struct KdPartCounts {
    std::size_t below = 0, above = 0;
};

/// Writes the parts of `references`, each of which begins below and ends above the plane, that lie below and above it, in
/// their order, and returns how many: what split_reference does with each, the same to the last bit, many at once. The
/// part below owns the primitive where there is one. Room for all of them in both; `below` may begin at the references
/// or before them in the same memory.
KdPartCounts split_references(std::span<const KdReference> references, const TriangleMesh& mesh, int axis, float plane,
                              KdReference* below, KdReference* above);

}  // namespace rayuela
