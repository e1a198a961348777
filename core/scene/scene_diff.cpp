#include "core/scene/scene_diff.h"

#include "core/scene/light_factor.h"

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

/// What becomes of a hidden object shows when it does.
bool stays_hidden(const Object& a, const Object& b) {
    return !a.visible && !b.visible;
}

bool same_geometry(const Object& a, const Object& b) {
    if (a.id != b.id) return false;
    if (stays_hidden(a, b)) return true;
    return a.parent == b.parent && a.visible == b.visible && a.transform == b.transform &&
           same_surface(a.shape, b.shape);
}

bool same_assignment(const Object& a, const Object& b) {
    if (stays_hidden(a, b)) return true;
    if (a.material != b.material) return false;
    const auto* gltf_a = std::get_if<Gltf>(&a.shape);
    const auto* gltf_b = std::get_if<Gltf>(&b.shape);
    return !gltf_a || !gltf_b || gltf_a->materials == gltf_b->materials;
}

bool same_value(const MaterialEntry& a, const MaterialEntry& b) {
    return a.id == b.id && a.material == b.material;
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
           a.render.light_choice == b.render.light_choice && a.render.seed == b.render.seed;
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
    const bool same_surfaces = !changes.geometry && !changes.assignment;
    if (same_surfaces && (changes.materials || changes.environment)) changes.light = light_factor(before, after);
    return changes;
}

SceneChanges all_changes() {
    return {.film_size = true,
            .camera = true,
            .sampling = true,
            .materials = true,
            .geometry = true,
            .assignment = true,
            .environment = true,
            .accel = true};
}

}  // namespace rayuela
