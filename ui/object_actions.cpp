#include "ui/object_actions.h"

#include "ui/camera_views.h"
#include "ui/file_actions.h"
#include "ui/icons.h"
#include "ui/transform_edit.h"
#include "ui/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

/// The nearest of 1, 2, 5, 10, 20... below.
float round_number(float value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const float power = std::pow(10.0f, std::floor(std::log10(value)));
    const float digit = value / power;
    return power * (digit >= 5 ? 5.0f : digit >= 2 ? 2.0f : 1.0f);
}

/// A fifth of the height that the camera sees around its target.
float suitable_size(const Camera& camera) {
    const float distance = glm::distance(camera.position, camera.target);
    return round_number(0.4f * distance * std::tan(glm::radians(camera.vfov) / 2));
}

/// The list that new objects go into: the selected one, or the one that holds the selection.
ObjectId target_list(const Editor& editor) {
    const Object* selected = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    if (!selected) return {};
    return std::holds_alternative<ObjectList>(selected->shape) ? selected->id : selected->parent;
}

template <typename Change>
void edit_object(Editor& editor, ObjectId id, std::string_view verb, const Change& change) {
    const Object* object = editor.scene().find(id);
    if (!object) return;
    Object changed = *object;
    change(changed);
    editor.edit(SetObject{std::move(changed)}, fmt::format("{} {}", verb, object->name));
}

}  // namespace

const char* shape_icon(const Shape& shape) {
    struct Visitor {
        const char* operator()(const Sphere&) const { return icon::kSphere; }
        const char* operator()(const Plane&) const { return icon::kPlane; }
        const char* operator()(const Box&) const { return icon::kBox; }
        const char* operator()(const Triangle&) const { return icon::kTriangle; }
        const char* operator()(const Quad&) const { return icon::kQuad; }
        const char* operator()(const ObjectList&) const { return icon::kGroup; }
        const char* operator()(const Mesh&) const { return icon::kMesh; }
        const char* operator()(const Gltf&) const { return icon::kGltf; }
    };
    return std::visit(Visitor{}, shape);
}

Color swatch_color(const Material& material) {
    Color swatch(0.8f);
    bool found = false;
    std::visit(
        [&]<typename T>(const T& value) {
            T::visit_fields(value, [&]<typename F>(const F& member, const Field& field) {
                if constexpr (std::is_same_v<F, ColorValue>) {
                    if (found) return;
                    found = true;
                    const float strength = max_component(member.value);
                    const bool too_bright = field.role == FieldRole::radiance && strength > 1;
                    swatch = too_bright ? member.value / strength : member.value;
                }
            });
        },
        material);
    return swatch;
}

int user_count(const Scene& scene, MaterialId id) {
    return static_cast<int>(std::ranges::count_if(scene.objects, [&](const Object& object) {
        const Gltf* gltf = std::get_if<Gltf>(&object.shape);
        return object.material == id || (gltf && !object.material && std::ranges::count(gltf->materials, id) > 0);
    }));
}

void add_object(Editor& editor, const Shape& shape) {
    if (std::visit([]<typename T>(const T&) { return needs_file<T>(); }, shape)) {
        import_dialog(editor);
        return;
    }
    const Scene& scene = editor.scene();
    Object object;
    object.shape = shape;
    object.parent = target_list(editor);
    const bool is_group = std::holds_alternative<ObjectList>(shape);
    if (!is_group) {
        Affine world;
        world.translation = scene.camera.target;
        // A plane is as large everywhere.
        if (!std::holds_alternative<Plane>(shape)) world.linear = Mat3(suitable_size(scene.camera));
        object.transform = transform_from(scene.to_world(object.parent).inverse() * world);
        if (const Object* selected = editor.selection ? scene.find(*editor.selection) : nullptr) {
            object.material = selected->material;
        } else if (!scene.materials.empty()) {
            object.material = scene.materials.front().id;
        }
    }
    const ObjectId id{scene.next_id};
    if (editor.edit(AddObject{std::move(object)}, fmt::format("Add {}", type_label(shape)))) editor.selection = id;
}

void duplicate_selection(Editor& editor) {
    const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    if (!object) return;
    const ObjectId copy{editor.scene().next_id};
    if (editor.edit(DuplicateObject{object->id}, "Duplicate " + object->name)) editor.selection = copy;
}

void delete_selection(Editor& editor) {
    const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    if (object) editor.edit(RemoveObject{object->id}, "Delete " + object->name);
}

void set_visible(Editor& editor, ObjectId id, bool visible) {
    edit_object(editor, id, visible ? "Show" : "Hide", [&](Object& object) { object.visible = visible; });
}

void rename_object(Editor& editor, ObjectId id, const std::string& name) {
    edit_object(editor, id, "Rename", [&](Object& object) { object.name = name; });
}

void move_into(Editor& editor, ObjectId id, ObjectId list) {
    const Scene& scene = editor.scene();
    edit_object(editor, id, "Move", [&](Object& object) {
        if (object.parent == list) return;
        const Affine world = scene.to_world(id);
        object.parent = list;
        const Affine parent = scene.to_world(list);
        if (parent != scene.to_world(scene.find(id)->parent))
            object.transform = transform_from(parent.inverse() * world);
    });
}

void assign_material(Editor& editor, ObjectId id, MaterialId material) {
    edit_object(editor, id, "Assign material to", [&](Object& object) { object.material = material; });
}

void add_material(Editor& editor, const std::string& name, const Material& material) {
    const MaterialId id{editor.scene().next_id};
    if (!editor.edit(AddMaterial{name, material}, "Add material")) return;
    if (editor.selection) {
        assign_material(editor, *editor.selection, id);
    } else {
        editor.selected_material = id;
    }
}

void frame_bounds_of(Editor& editor, std::optional<ObjectId> id) {
    const FilmSettings& film = editor.shown().film;
    const float aspect = static_cast<float>(film.width) / static_cast<float>(film.height);
    const Camera& camera = editor.scene().camera;
    editor.edit(SetCamera{framing(camera, bounds_to_frame(editor.scene(), id), aspect)}, "Frame");
}

}  // namespace rayuela
