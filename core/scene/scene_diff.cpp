#include "core/scene/scene_diff.h"

#include "core/materials/bsdf.h"

#include <algorithm>
#include <unordered_map>

namespace rayuela {

namespace {

/// The same surface, whatever file it is said to come from and whatever materials it brings.
bool same_surface(const Shape& a, const Shape& b) {
    if (a.index() != b.index()) return false;
    if (const auto* mesh = std::get_if<Mesh>(&a)) return mesh->data == std::get<Mesh>(b).data;
    if (const auto* gltf = std::get_if<Gltf>(&a)) return gltf->geometry == std::get<Gltf>(b).geometry;
    return a == b;
}

bool same_geometry(const Object& a, const Object& b) {
    return a.id == b.id && a.parent == b.parent && a.visible == b.visible && a.transform == b.transform &&
           same_surface(a.shape, b.shape);
}

bool same_assignment(const Object& a, const Object& b) {
    if (a.material != b.material) return false;
    const auto* gltf_a = std::get_if<Gltf>(&a.shape);
    const auto* gltf_b = std::get_if<Gltf>(&b.shape);
    return !gltf_a || !gltf_b || gltf_a->materials == gltf_b->materials;
}

bool same_value(const MaterialEntry& a, const MaterialEntry& b) {
    return a.id == b.id && a.material == b.material;
}

/// A visible object that emits, as the light table sees it: where it stands among the objects counts, because the table
/// names what it samples by index.
struct Light {
    const Object* object;
    Affine to_world;
    std::size_t surfaces_before, visible_surfaces_before;
    std::vector<std::pair<std::size_t, const Material*>> emitters;  ///< Among its materials, with their index.

    bool operator==(const Light& other) const {
        const auto same_emitter = [](const auto& a, const auto& b) {
            return a.first == b.first && *a.second == *b.second;
        };
        return object->id == other.object->id && to_world == other.to_world &&
               surfaces_before == other.surfaces_before && visible_surfaces_before == other.visible_surfaces_before &&
               same_surface(object->shape, other.object->shape) && same_assignment(*object, *other.object) &&
               std::ranges::equal(emitters, other.emitters, same_emitter);
    }
};

/// How many surfaces a shape becomes when the scene is flattened.
std::size_t surface_count(const Shape& shape) {
    if (std::holds_alternative<ObjectList>(shape)) return 0;
    const auto* gltf = std::get_if<Gltf>(&shape);
    return gltf ? (gltf->geometry ? gltf->geometry->parts.size() : 0) : 1;
}

/// All lights of a scene, in the order of its objects.
std::vector<Light> lights(const Scene& scene) {
    std::unordered_map<std::uint32_t, std::size_t> emissive;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        if (is_emissive(scene.materials[i].material)) emissive.emplace(scene.materials[i].id.value, i);
    }
    std::vector<Light> result;
    if (emissive.empty()) return result;

    struct Placement {
        Affine to_world;
        bool visible;
    };
    std::unordered_map<std::uint32_t, Placement> lists;
    std::size_t surfaces = 0, visible_surfaces = 0;
    for (const Object& object : scene.objects) {
        Placement placement{object.transform.affine(), object.visible};
        if (object.parent) {
            const Placement& parent = lists.at(object.parent.value);
            placement = {parent.to_world * placement.to_world, parent.visible && placement.visible};
        }
        if (std::holds_alternative<ObjectList>(object.shape)) lists.emplace(object.id.value, placement);
        Light light{&object, placement.to_world, surfaces, visible_surfaces, {}};
        surfaces += surface_count(object.shape);
        if (!placement.visible) continue;
        visible_surfaces += surface_count(object.shape);

        const auto add = [&](MaterialId id) {
            const auto found = emissive.find(id.value);
            if (found != emissive.end())
                light.emitters.emplace_back(found->second, &scene.materials[found->second].material);
        };
        const auto* gltf = std::get_if<Gltf>(&object.shape);
        if (object.material || !gltf) {
            add(object.material);
        } else {
            std::ranges::for_each(gltf->materials, add);
        }
        if (!light.emitters.empty()) result.push_back(std::move(light));
    }
    return result;
}

/// Of the objects that are in both; others are a change of geometry.
bool changed_assignment(const Scene& before, const Scene& after) {
    std::unordered_map<std::uint32_t, const Object*> olds;
    if (!std::ranges::equal(before.objects, after.objects, {}, &Object::id, &Object::id)) {
        for (const Object& object : before.objects) olds.emplace(object.id.value, &object);
        return std::ranges::any_of(after.objects, [&](const Object& object) {
            const auto old = olds.find(object.id.value);
            return old != olds.end() && !same_assignment(*old->second, object);
        });
    }
    return !std::ranges::equal(before.objects, after.objects, same_assignment);
}

/// Settings that change which samples are taken.
bool same_sampling(const Scene& a, const Scene& b) {
    return a.film.filter == b.film.filter && a.render.max_bounces == b.render.max_bounces &&
           a.render.rr_start == b.render.rr_start && a.render.sampler == b.render.sampler &&
           a.render.seed == b.render.seed;
}

}  // namespace

SceneChanges diff(const Scene& before, const Scene& after) {
    SceneChanges changes;
    changes.film_size = before.film.width != after.film.width || before.film.height != after.film.height;
    changes.camera = before.camera != after.camera;
    changes.sampling = !same_sampling(before, after);
    changes.materials = !std::ranges::equal(before.materials, after.materials, same_value);
    changes.geometry = !std::ranges::equal(before.objects, after.objects, same_geometry);
    changes.assignment = changed_assignment(before, after);
    changes.environment = before.environment != after.environment;
    changes.accel = before.render.accel != after.render.accel;
    if (changes.materials || changes.geometry || changes.assignment) changes.emission = lights(before) != lights(after);
    return changes;
}

SceneChanges all_changes() {
    return {.film_size = true,
            .camera = true,
            .sampling = true,
            .materials = true,
            .emission = true,
            .geometry = true,
            .assignment = true,
            .environment = true,
            .accel = true};
}

}  // namespace rayuela
