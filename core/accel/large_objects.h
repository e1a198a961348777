#pragma once

#include "core/accel/traced_object.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayuela {

/// At most so many primitives stand outside a tree for their size.
inline constexpr std::size_t kLargePrimitives = 16;

/// Of primitives with these bounds, the ones that are better tested with every ray than in the leaves of a tree over all:
/// largest first, each of at least an eighth of the surface of the bounds of all that are smaller, and of `rest`. A ray would
/// test them in leaf after leaf, and the ground that a scene stands on would stretch the tree far beyond it. Those whose
/// bounds do not fit a tree are left out.
std::vector<std::uint32_t> find_large(std::span<const Bounds3> bounds, Bounds3 rest);

/// The same of objects, whose bounds these are. Planes and meshes are left out.
std::vector<std::uint32_t> find_large_objects(std::span<const TracedObject> objects, std::span<const Bounds3> bounds);

}  // namespace rayuela
