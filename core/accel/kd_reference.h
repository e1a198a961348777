#pragma once

#include "core/math/bounds.h"
#include "core/shapes/mesh.h"

#include <cstdint>

namespace rayuela {

/// A primitive in a node under construction: `box` contains its part within the node's cell.
struct KdReference {
    Bounds3 box;
    std::uint32_t primitive = 0;
    /// 1 or 0: one reference of each primitive owns it, which counts for progress and for leaf sizes. Not a bool, whose
    /// padding makes copies slow.
    std::uint32_t owned = 1;
};

/// A reference on both sides of a plane; a side that the primitive does not reach is empty.
struct KdSides {
    Bounds3 below, above;
};

/// The parts of `reference` below and above the plane. Geometry within the plane counts as below. With a mesh the
/// triangle is clipped (its bounds rounded outward), else only the box.
KdSides split_reference(const KdReference& reference, const TriangleMesh* mesh, int axis, float plane);

}  // namespace rayuela
