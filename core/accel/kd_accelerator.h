#pragma once

#include "core/accel/kd_kernels.h"

#include <unordered_map>

namespace rayuela {

/// Up to this many objects make one leaf, whatever the leaf size (the `median` split always splits). Measured: triangles and
/// spheres in a room take as long either way where they are about 300, and 0.65 to 0.8 of the tree's time below 130.
inline constexpr std::size_t kFewObjects = 160;

inline bool tests_few_objects(const AccelSettings& settings, std::size_t objects) {
    return settings.split == KdSplit::sah && objects <= kFewObjects;
}

/// A mesh of so many triangles is worth a draft where that will do: a tree with leaves of this size, which takes about a third
/// of the time to build and is good enough for a preview. The tree that was asked for is made from its cuts, to the same
/// bits. A tree for another leaf size that is there already will do as well.
inline constexpr std::size_t kDraftTriangles = 1 << 18;
inline constexpr int kDraftLeafSize = 1024;

inline bool deserves_draft(const TriangleMesh& mesh, const AccelSettings& settings) {
    return settings.draft && settings.split == KdSplit::sah && settings.leaf_size < kDraftLeafSize &&
           mesh.triangles.size() >= kDraftTriangles;
}

/// Two levels of kd-trees: one over each distinct mesh in its own space, one over the objects. Planes are tested in turn.
class KdAccelerator final : public Accelerator {
public:
    /// Null when cancelled.
    static std::shared_ptr<const KdAccelerator> build(std::vector<GeometryInstance> instances,
                                                      const AccelSettings& settings, const KdAccelerator* previous,
                                                      const KdAccelerator* better, BuildControl& control);

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override { kd_intersect(scene(), rays, hits); }
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override {
        kd_occluded(scene(), rays, blocked);
    }
    AccelStats stats() const override { return stats_; }
    const AccelSettings& settings() const override { return settings_; }
    std::span<const GeometryInstance> instances() const override { return instances_; }
    Bounds3 bounds() const override { return all_bounds_; }

    /// The tree of the mesh of an object; null for other shapes. For tests and statistics.
    const MeshTree* mesh_tree(std::uint32_t object) const { return mesh_of_object_[object]; }

    /// False where all objects are tested in turn.
    bool has_object_tree() const { return tree_.nodes.size() > 1; }
    /// Objects tested in turn beside a tree over all others, unless AccelSettings::few_objects is off.
    std::size_t large_objects() const { return large_objects_; }

private:
    KdAccelerator() = default;
    bool build_meshes(BuildControl& control);
    bool build_objects(BuildControl& control);
    bool build_object_tree(std::span<const Bounds3> bounds, BuildControl& control);
    KdScene scene() const {
        return {objects_, mesh_of_object_, planes_, all_apart_ ? nullptr : &tree_, &leaves_, bounds_, all_bounds_};
    }

    std::vector<GeometryInstance> instances_;
    AccelSettings settings_;
    std::vector<TracedObject> objects_;
    std::vector<std::uint32_t> planes_;
    /// Those of meshes that are out of sight stay for as long as the mesh and the split do, of whatever leaf size they are.
    std::unordered_map<const TriangleMesh*, std::shared_ptr<const MeshTree>> mesh_trees_;
    std::vector<const MeshTree*> mesh_of_object_;
    KdTree tree_;
    ObjectLeaves leaves_;
    bool all_apart_ = false;  ///< No tree is needed.
    std::size_t large_objects_ = 0;
    std::vector<Bounds3> bounds_;  ///< As KdScene::bounds.
    Bounds3 all_bounds_;
    AccelStats stats_;
};

}  // namespace rayuela
