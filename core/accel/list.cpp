#include "core/accel/list.h"

#include <algorithm>
#include <set>

namespace rayuela {
namespace {

enum class Query { closest, any };

void intersect_mesh(const TracedObject& object, std::uint32_t index, const TracedRay& world, const Ray& ray,
                    Query query, Hit& best) {
    const TriangleMesh& mesh = *object.mesh();
    const TriangleRay local = object.in_world ? world.triangle_ray : TriangleRay(object.to_local.ray(world.ray));
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        const TRange range{ray.t_min, std::min(ray.t_max, best.t)};
        ShapeHit hit;
        if (!intersect_triangle(local, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z], range, hit))
            continue;
        keep_closer(hit, index, i, best);
        if (query == Query::any) return;
    }
}

Hit trace(std::span<const TracedObject> objects, const Ray& ray, Query query) {
    Hit best;
    if (!can_hit(ray)) return best;
    const TracedRay world{RayD(ray)};
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        ShapeHit hit;
        const TRange range{ray.t_min, std::min(ray.t_max, best.t)};
        if (objects[i].mesh()) {
            intersect_mesh(objects[i], i, world, ray, query, best);
        } else if (intersect_shape(objects[i], world, range, hit)) {
            keep_closer(hit, i, hit.primitive, best);
        }
        if (query == Query::any && best.valid()) break;
    }
    return best;
}

}  // namespace

ListAccelerator::ListAccelerator(std::vector<GeometryInstance> instances, const AccelSettings& settings)
    : instances_(std::move(instances)), settings_(settings) {
    std::set<const TriangleMesh*> counted;
    objects_.reserve(instances_.size());
    for (const GeometryInstance& instance : instances_) {
        const TracedObject& object = objects_.emplace_back(instance);
        const TriangleMesh* mesh = object.mesh();
        bounds_.extend(world_bounds(object, instance, mesh ? bounds_of_triangles(*mesh) : Bounds3()));
        if (!mesh) ++stats_.primitives;
        if (mesh && counted.insert(mesh).second) stats_.primitives += mesh->triangles.size();
    }
    stats_.memory_bytes = objects_.size() * sizeof(TracedObject);
}

void ListAccelerator::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace(objects_, rays[i], Query::closest);
}

void ListAccelerator::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
    for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = trace(objects_, rays[i], Query::any).valid() ? 1 : 0;
}

}  // namespace rayuela
