#pragma once

#include "core/math/result.h"
#include "core/scene/scene.h"

#include <variant>

namespace rayuela {

struct SetCamera {
    Camera camera;
};
struct SetFilm {
    FilmSettings film;
};
struct SetEnvironment {
    Environment environment;
};
struct SetRenderSettings {
    RenderSettings render;
};
/// A new material; its id is given by apply (scene.next_id before the edit). A taken or empty name gets a number.
struct AddMaterial {
    std::string name;
    Material material;
};
/// Replaces value and name of the material with that id.
struct SetMaterial {
    MaterialEntry entry;
};
/// Objects that used it fall back to the default material.
struct RemoveMaterial {
    MaterialId id;
};
/// A new object; `object.id` is ignored and given by apply (scene.next_id before the edit). An empty name gets one.
struct AddObject {
    Object object;
};
/// Replaces the object with that id: shape, transform, material, name, visibility, parent.
struct SetObject {
    Object object;
};
/// Removes the object and, of a list, its children.
struct RemoveObject {
    ObjectId id;
};
/// Copies the object (and a list's children) beside itself; the copy of `id` gets scene.next_id before the edit.
struct DuplicateObject {
    ObjectId id;
};
using SceneEdit = std::variant<SetCamera, SetFilm, SetEnvironment, SetRenderSettings, AddMaterial, SetMaterial,
                               RemoveMaterial, AddObject, SetObject, RemoveObject, DuplicateObject>;

/// The scene after the edit, or why it cannot be: out of range, unknown id, parent cycle, singular transform...
Result<Scene> apply(const Scene& scene, const SceneEdit& edit);

/// Every violation of the invariants of Scene, named by JSON path ("objects[3].radius: must be > 0, is -1").
Problems validate(const Scene& scene);

}  // namespace rayuela
