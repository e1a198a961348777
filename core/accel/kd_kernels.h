#pragma once

#include "core/accel/mesh_tree.h"
#include "core/accel/object_leaves.h"
#include "core/accel/traced_object.h"

#include <span>

namespace rayuela {

/// What the kernels read of a KdAccelerator or a ListAccelerator.
struct KdScene {
    std::span<const TracedObject> objects;
    std::span<const MeshTree* const> mesh_trees;  ///< One an object; null for all but meshes.
    std::span<const std::uint32_t> planes;        ///< Objects that no tree can hold.
    const KdTree* tree = nullptr;  ///< Over all other objects but those of leaves->apart; null where there are none.
    const ObjectLeaves* leaves = nullptr;
    std::span<const Bounds3> bounds;  ///< One an object, where any stands apart.
    Bounds3 all_bounds;               ///< Of all objects but planes.
    bool in_turn = false;             ///< Each mesh is one leaf, to be tested in turn: no trees.
};

/// Accelerator::intersect and Accelerator::occluded by the widest instructions of this machine.
void kd_intersect(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits);
void kd_occluded(const KdScene& scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked);

}  // namespace rayuela
