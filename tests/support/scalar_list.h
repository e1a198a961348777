#pragma once

#include "core/accel/traced_object.h"
#include "tests/support/accel_scenes.h"

#include <algorithm>

namespace rayuela::test {

/// Tests every object in turn, and of a mesh every triangle in turn, one ray at a time and in double: slow and plain, the
/// oracle for what the kernels do.
class ScalarList final : public Accelerator {
public:
    explicit ScalarList(std::vector<GeometryInstance> instances) : instances_(std::move(instances)) {
        for (const GeometryInstance& instance : instances_) {
            const TracedObject& object = objects_.emplace_back(instance);
            const TriangleMesh* mesh = object.mesh();
            bounds_.extend(world_bounds(object, instance, mesh ? bounds_of_triangles(*mesh) : Bounds3()));
        }
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override {
        for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = closest(rays[i]);
    }
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override {
        for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = closest(rays[i]).valid() ? 1 : 0;
    }
    AccelStats stats() const override { return {}; }
    const AccelSettings& settings() const override { return settings_; }
    std::span<const GeometryInstance> instances() const override { return instances_; }
    Bounds3 bounds() const override { return bounds_; }

private:
    Hit closest(const Ray& ray) const {
        Hit best;
        if (!can_hit(ray)) return best;
        const TracedRay world{RayD(ray)};
        for (std::uint32_t i = 0; i < objects_.size(); ++i) {
            ShapeHit hit;
            const TRange range{ray.t_min, std::min(ray.t_max, best.t)};
            if (objects_[i].mesh()) {
                intersect_mesh(i, world, ray, best);
            } else if (intersect_shape(objects_[i], world, range, hit)) {
                keep_closer(hit, i, hit.primitive, best);
            }
        }
        return best;
    }

    void intersect_mesh(std::uint32_t index, const TracedRay& world, const Ray& ray, Hit& best) const {
        const TracedObject& object = objects_[index];
        const TriangleMesh& mesh = *object.mesh();
        const TriangleRay local = object.in_world ? world.triangle_ray : TriangleRay(object.to_local.ray(world.ray));
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            const glm::uvec3& t = mesh.triangles[i];
            const TRange range{ray.t_min, std::min(ray.t_max, best.t)};
            ShapeHit hit;
            if (!intersect_triangle(local, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z], range, hit))
                continue;
            keep_closer(hit, index, i, best);
        }
    }

    std::vector<GeometryInstance> instances_;
    std::vector<TracedObject> objects_;
    AccelSettings settings_{.kind = AcceleratorKind::list};
    Bounds3 bounds_;
};

inline std::shared_ptr<const Accelerator> scalar_list(std::vector<GeometryInstance> instances) {
    return std::make_shared<const ScalarList>(std::move(instances));
}

}  // namespace rayuela::test
