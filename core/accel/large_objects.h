#pragma once

#include "core/accel/traced_object.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayuela {

/// At most so many objects stand outside a tree for their size.
inline constexpr std::size_t kLargeObjects = 16;

/// The objects that are better tested with every ray than in the leaves of a tree over all: largest first, each of at least an
/// eighth of the surface of the bounds of all that are smaller. A ray would test them in leaf after leaf, and the ground that
/// a scene stands on would stretch the tree far beyond it. Planes, meshes and what no tree would hold are left out.
/// `bounds` are those of the objects.
std::vector<std::uint32_t> find_large_objects(std::span<const TracedObject> objects, std::span<const Bounds3> bounds);

}  // namespace rayuela
