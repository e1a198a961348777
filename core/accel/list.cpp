#include "core/accel/list.h"

namespace rayuela {

ListAccelerator::ListAccelerator(std::vector<GeometryInstance> instances, const AccelSettings& settings,
                                 const ListAccelerator* previous)
    : instances_(std::move(instances)), settings_(settings) {
    std::vector<std::uint32_t> in_turn;
    objects_.reserve(instances_.size());
    for (std::uint32_t i = 0; i < instances_.size(); ++i) {
        const TracedObject& object = objects_.emplace_back(instances_[i]);
        const MeshTree* mesh = triangles_of(object, previous);
        mesh_of_object_.push_back(mesh);
        bounds_.push_back(world_bounds(object, instances_[i], mesh ? mesh->bounds : Bounds3()));
        if (!mesh) ++stats_.primitives;
        if (object.is_plane()) planes_.push_back(i);
        if (!fits_a_tree(bounds_.back())) continue;
        all_bounds_.extend(bounds_.back());
        in_turn.push_back(i);
    }
    leaves_ = make_object_leaves(objects_, bounds_, nullptr, in_turn);
    for (const auto& [mesh, triangles] : meshes_) {
        stats_.primitives += triangles->stats.primitives;
        stats_.memory_bytes += triangles->stats.memory_bytes;
    }
    stats_.memory_bytes += objects_.size() * sizeof(TracedObject) + leaves_.memory_bytes();
}

/// Null for other shapes.
const MeshTree* ListAccelerator::triangles_of(const TracedObject& object, const ListAccelerator* previous) {
    if (!object.mesh()) return nullptr;
    std::shared_ptr<const MeshTree>& triangles = meshes_[object.mesh()];
    if (triangles) return triangles.get();
    if (previous) {
        const auto known = previous->meshes_.find(object.mesh());
        if (known != previous->meshes_.end() && !known->second->mesh.expired()) triangles = known->second;
    }
    if (!triangles) triangles = make_mesh_leaf(std::get<std::shared_ptr<const TriangleMesh>>(object.shape));
    return triangles.get();
}

}  // namespace rayuela
