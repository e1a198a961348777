#include "core/scene/scene.h"

#include <algorithm>

namespace rayuela {

const Object* Scene::find(ObjectId id) const {
    const auto found = std::ranges::find(objects, id, &Object::id);
    return id && found != objects.end() ? &*found : nullptr;
}

const MaterialEntry* Scene::find(MaterialId id) const {
    const auto found = std::ranges::find(materials, id, &MaterialEntry::id);
    return id && found != materials.end() ? &*found : nullptr;
}

const MaterialEntry* Scene::find_material(std::string_view name) const {
    const auto found = std::ranges::find(materials, name, &MaterialEntry::name);
    return found != materials.end() ? &*found : nullptr;
}

Affine Scene::to_world(ObjectId id) const {
    Affine result;
    for (const Object* object = find(id); object; object = find(object->parent)) {
        result = object->transform.affine() * result;
    }
    return result;
}

bool Scene::is_visible(ObjectId id) const {
    for (const Object* object = find(id); object; object = find(object->parent)) {
        if (!object->visible) return false;
    }
    return true;
}

namespace {

Bounds3 local_bounds(const Shape& shape) {
    struct Visitor {
        Bounds3 operator()(const Sphere& s) const { return {s.center - s.radius, s.center + s.radius}; }
        Bounds3 operator()(const Plane&) const { return {}; }
        Bounds3 operator()(const Box& b) const { return {b.min, b.max}; }
        Bounds3 operator()(const Triangle& t) const {
            Bounds3 bounds;
            for (const Vec3& vertex : t.vertices) bounds.extend(vertex);
            return bounds;
        }
        Bounds3 operator()(const Quad& q) const {
            Bounds3 bounds;
            for (const Vec3& corner : {q.point, q.point + q.u, q.point + q.v, q.point + q.u + q.v})
                bounds.extend(corner);
            return bounds;
        }
        Bounds3 operator()(const ObjectList&) const { return {}; }
        Bounds3 operator()(const Mesh& m) const { return m.data ? m.data->bounds : Bounds3{}; }
        Bounds3 operator()(const Gltf& g) const {
            Bounds3 bounds;
            if (!g.geometry) return bounds;
            for (const GltfPart& part : g.geometry->parts) bounds.extend(part.to_file.bounds(part.mesh->bounds));
            return bounds;
        }
    };
    return std::visit(Visitor{}, shape);
}

}  // namespace

Bounds3 world_bounds(const Scene& scene, ObjectId id) {
    Bounds3 bounds;
    const Object* object = scene.find(id);
    if (!object) return bounds;
    bounds.extend(scene.to_world(id).bounds(local_bounds(object->shape)));
    for (const Object& child : scene.objects) {
        if (child.parent == id) bounds.extend(world_bounds(scene, child.id));
    }
    return bounds;
}

Bounds3 world_bounds(const Scene& scene) {
    Bounds3 bounds;
    for (const Object& object : scene.objects) {
        if (scene.is_visible(object.id)) bounds.extend(scene.to_world(object.id).bounds(local_bounds(object.shape)));
    }
    return bounds;
}

}  // namespace rayuela
