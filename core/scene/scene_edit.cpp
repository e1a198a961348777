#include "core/scene/scene_edit.h"

#include "core/scene/validate.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace {

Result<Scene> unless(Problems problems, Scene scene) {
    if (!problems.empty()) return tl::unexpected(std::move(problems));
    return scene;
}

Object* find(Scene& scene, ObjectId id) {
    return const_cast<Object*>(std::as_const(scene).find(id));
}

MaterialEntry* find(Scene& scene, MaterialId id) {
    return const_cast<MaterialEntry*>(std::as_const(scene).find(id));
}

template <typename Variant>
std::string label(const Variant& variant) {
    return std::visit([](const auto& value) { return std::string(value.kLabel); }, variant);
}

std::string free_material_name(const Scene& scene, const std::string& name, const Material& material) {
    return unique_name(name.empty() ? label(material) : name,
                       [&](const std::string& candidate) { return scene.find_material(candidate) != nullptr; });
}

std::string free_object_name(const Scene& scene, const Object& object) {
    std::unordered_set<std::string_view> names;
    for (const Object& other : scene.objects) names.insert(other.name);
    return unique_name(object.name.empty() ? label(object.shape) : object.name,
                       [&](const std::string& candidate) { return names.contains(candidate); });
}

/// Whether the object or one of its ancestors is `ancestor`.
bool is_within(const Scene& scene, const Object& object, ObjectId ancestor) {
    for (const Object* o = &object; o; o = o->parent ? scene.find(o->parent) : nullptr) {
        if (o->id == ancestor) return true;
    }
    return false;
}

/// For each object whether it is `root` or stands below it. Parents come first, so one pass is enough.
std::vector<bool> subtree(const Scene& scene, ObjectId root) {
    std::vector<bool> inside(scene.objects.size());
    std::unordered_set<std::uint32_t> ids{root.value};
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const Object& object = scene.objects[i];
        inside[i] = object.id == root || (object.parent && ids.contains(object.parent.value));
        if (inside[i]) ids.insert(object.id.value);
    }
    return inside;
}

Problems check_object(const Scene& scene, const Object& object) {
    Problems problems = check_shape(object.shape, "");
    Problems transform = check_transform(object.transform, object.shape, "transform");
    problems.insert(problems.end(), transform.begin(), transform.end());
    if (object.material && !scene.find(object.material)) problems.push_back({"", "material", "does not exist"});
    if (const auto* gltf = std::get_if<Gltf>(&object.shape)) {
        for (const MaterialId id : gltf->materials) {
            if (id && !scene.find(id)) problems.push_back({"", "materials", "uses a material that does not exist"});
        }
    }
    if (object.parent) {
        const Object* parent = scene.find(object.parent);
        if (!parent) {
            problems.push_back({"", "parent", "does not exist"});
        } else if (!std::holds_alternative<ObjectList>(parent->shape)) {
            problems.push_back({"", "parent", "is no list"});
        } else if (is_within(scene, *parent, object.id)) {
            problems.push_back({"", "parent", "an object cannot stand below itself"});
        }
    }
    return problems;
}

/// Moves the object and what stands below it to the end where its parent does not come before it.
void order_after_parent(Scene& scene, const Object& object) {
    if (!object.parent) return;
    const ObjectId id = object.id;
    const auto at = std::ranges::find(scene.objects, id, &Object::id);
    const auto parent = std::ranges::find(scene.objects, object.parent, &Object::id);
    if (parent < at) return;
    const std::vector<bool> moves = subtree(scene, id);
    std::vector<Object> staying, moving;
    for (std::size_t i = 0; i < moves.size(); ++i) (moves[i] ? moving : staying).push_back(std::move(scene.objects[i]));
    staying.insert(staying.end(), std::make_move_iterator(moving.begin()), std::make_move_iterator(moving.end()));
    scene.objects = std::move(staying);
}

struct Apply {
    const Scene& before;

    Result<Scene> operator()(const SetCamera& edit) const {
        Scene scene = before;
        scene.camera = edit.camera;
        return unless(check_camera(edit.camera, "camera"), std::move(scene));
    }

    Result<Scene> operator()(const SetFilm& edit) const {
        Scene scene = before;
        scene.film = edit.film;
        return unless(check_film(edit.film, "film"), std::move(scene));
    }

    Result<Scene> operator()(const SetEnvironment& edit) const {
        Scene scene = before;
        scene.environment = edit.environment;
        return unless(check_environment(edit.environment, "environment"), std::move(scene));
    }

    Result<Scene> operator()(const SetRenderSettings& edit) const {
        Scene scene = before;
        scene.render = edit.render;
        return unless(check_render_settings(edit.render, "render"), std::move(scene));
    }

    Result<Scene> operator()(const AddMaterial& edit) const {
        Scene scene = before;
        const std::string name = free_material_name(scene, edit.name, edit.material);
        scene.materials.push_back({MaterialId{scene.next_id++}, name, edit.material});
        return unless(check_material(edit.material, ""), std::move(scene));
    }

    Result<Scene> operator()(const SetMaterial& edit) const {
        Scene scene = before;
        MaterialEntry* entry = find(scene, edit.entry.id);
        if (!entry) return fail("", "", "the material does not exist");
        if (edit.entry.name.empty()) return fail("", "name", "must not be empty");
        const MaterialEntry* namesake = before.find_material(edit.entry.name);
        if (namesake && namesake->id != edit.entry.id) {
            return fail("", "name", "'" + edit.entry.name + "' is the name of another material");
        }
        *entry = edit.entry;
        return unless(check_material(edit.entry.material, ""), std::move(scene));
    }

    Result<Scene> operator()(const RemoveMaterial& edit) const {
        if (!before.find(edit.id)) return fail("", "", "the material does not exist");
        Scene scene = before;
        std::erase_if(scene.materials, [&](const MaterialEntry& entry) { return entry.id == edit.id; });
        for (Object& object : scene.objects) {
            if (object.material == edit.id) object.material = {};
            if (auto* gltf = std::get_if<Gltf>(&object.shape)) {
                std::ranges::replace(gltf->materials, edit.id, MaterialId{});
            }
        }
        return scene;
    }

    Result<Scene> operator()(const AddObject& edit) const {
        Scene scene = before;
        Object object = edit.object;
        object.id = ObjectId{scene.next_id++};
        object.name = free_object_name(before, object);
        Problems problems = check_object(before, object);
        scene.objects.push_back(std::move(object));
        return unless(std::move(problems), std::move(scene));
    }

    Result<Scene> operator()(const SetObject& edit) const {
        const Object* old = before.find(edit.object.id);
        if (!old) return fail("", "", "the object does not exist");
        Problems problems = check_object(before, edit.object);
        if (std::holds_alternative<ObjectList>(old->shape) && !std::holds_alternative<ObjectList>(edit.object.shape) &&
            std::ranges::find(before.objects, edit.object.id, &Object::parent) != before.objects.end()) {
            problems.push_back({"", "", "a list with members cannot become another shape"});
        }
        if (!problems.empty()) return tl::unexpected(std::move(problems));
        Scene scene = before;
        *find(scene, edit.object.id) = edit.object;
        order_after_parent(scene, edit.object);
        return scene;
    }

    Result<Scene> operator()(const RemoveObject& edit) const {
        if (!before.find(edit.id)) return fail("", "", "the object does not exist");
        const std::vector<bool> removed = subtree(before, edit.id);
        Scene scene = before;
        std::size_t index = 0;
        std::erase_if(scene.objects, [&](const Object&) { return removed[index++]; });
        return scene;
    }

    Result<Scene> operator()(const DuplicateObject& edit) const {
        if (!before.find(edit.id)) return fail("", "", "the object does not exist");
        const std::vector<bool> inside = subtree(before, edit.id);
        Scene scene = before;
        std::vector<Object> copies;
        std::unordered_map<std::uint32_t, ObjectId> copy_of;
        std::size_t end = 0;
        for (std::size_t i = 0; i < inside.size(); ++i) {
            if (!inside[i]) continue;
            Object copy = before.objects[i];
            copy.id = copy_of[copy.id.value] = ObjectId{scene.next_id++};
            if (copies.empty()) {
                copy.name = free_object_name(before, copy);
            } else {
                copy.parent = copy_of[copy.parent.value];
            }
            copies.push_back(std::move(copy));
            end = i + 1;
        }
        scene.objects.insert(scene.objects.begin() + static_cast<std::ptrdiff_t>(end), copies.begin(), copies.end());
        return scene;
    }
};

}  // namespace

Result<Scene> apply(const Scene& scene, const SceneEdit& edit) {
    return std::visit(Apply{scene}, edit);
}

}  // namespace rayuela
