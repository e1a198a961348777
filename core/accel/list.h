#pragma once

#include "core/accel/kd_kernels.h"

#include <unordered_map>

namespace rayuela {

/// Tests every object, and of a mesh every triangle, without any order: 16 rays with one of them at a time.
class ListAccelerator final : public Accelerator {
public:
    /// Meshes that `previous` (may be null) has are shared.
    ListAccelerator(std::vector<GeometryInstance> instances, const AccelSettings& settings,
                    const ListAccelerator* previous);

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override { kd_intersect(scene(), rays, hits); }
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override {
        kd_occluded(scene(), rays, blocked);
    }
    AccelStats stats() const override { return stats_; }
    const AccelSettings& settings() const override { return settings_; }
    std::span<const GeometryInstance> instances() const override { return instances_; }
    Bounds3 bounds() const override { return all_bounds_; }

private:
    const MeshTree* triangles_of(const TracedObject& object, const ListAccelerator* previous);
    KdScene scene() const {
        return {.objects = objects_,
                .mesh_trees = mesh_of_object_,
                .planes = planes_,
                .leaves = &leaves_,
                .bounds = bounds_,
                .all_bounds = all_bounds_,
                .in_turn = true};
    }

    std::vector<GeometryInstance> instances_;
    AccelSettings settings_;
    std::vector<TracedObject> objects_;
    std::vector<std::uint32_t> planes_;
    std::unordered_map<const TriangleMesh*, std::shared_ptr<const MeshTree>> meshes_;  ///< One leaf each.
    std::vector<const MeshTree*> mesh_of_object_;
    ObjectLeaves leaves_;
    std::vector<Bounds3> bounds_;
    Bounds3 all_bounds_;
    AccelStats stats_;
};

}  // namespace rayuela
