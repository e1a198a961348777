#include "ui/file_actions.h"
#include "ui/icons.h"
#include "ui/object_actions.h"
#include "ui/panels/material_editor.h"
#include "ui/panels/panels.h"
#include "ui/transform_edit.h"
#include "ui/variants.h"
#include "ui/widgets.h"

#include <fmt/format.h>
#include <misc/cpp/imgui_stdlib.h>

namespace rayuela {
namespace {

bool section(const char* title, const char* tip) {
    // A heading should not look like a selection.
    ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetStyleColorVec4(ImGuiCol_TableHeaderBg));
    const bool open = ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen);
    ImGui::PopStyleColor();
    tooltip(tip);
    return open;
}

void draw_name(Editor& editor, const Object& object) {
    const float buttons = 3 * (ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shape_icon(object.shape));
    tooltip(type_label(object.shape));
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-buttons);
    std::string name = object.name;
    if (ImGui::InputText("##name", &name) && !name.empty()) rename_object(editor, object.id, name);
    tooltip("Name of the object.");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(object.visible ? icon::kVisible : icon::kHidden, "visible",
                    object.visible ? "Hide: it will not be rendered (H)." : "Show it again (H).")) {
        set_visible(editor, object.id, !object.visible);
    }
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(icon::kCopy, "duplicate", "Duplicate (Ctrl+D).")) duplicate_selection(editor);
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(icon::kDelete, "delete", "Delete (X); undo brings it back.")) delete_selection(editor);
}

/// What a shape has besides its fields, for a person to know.
std::string shape_details(const Shape& shape) {
    if (const Mesh* mesh = std::get_if<Mesh>(&shape); mesh && mesh->data) {
        return fmt::format("{} triangles, {} vertices{}{}", mesh->data->triangles.size(), mesh->data->positions.size(),
                           mesh->data->normals.empty() ? ", flat" : ", smooth", mesh->data->has_uvs() ? ", uv" : "");
    }
    if (const Gltf* gltf = std::get_if<Gltf>(&shape); gltf && gltf->geometry) {
        std::size_t triangles = 0;
        for (const GltfPart& part : gltf->geometry->parts) triangles += part.mesh->triangles.size();
        return fmt::format("{} parts, {} triangles", gltf->geometry->parts.size(), triangles);
    }
    return "";
}

void draw_shape(Editor& editor, const Object& object) {
    Object changed = object;
    ImGui::PushID("shape");
    const FieldActions actions{.browse_texture = {},
                               .browse_file = [&](std::string_view) { object_file_dialog(editor, object.id); }};
    const bool edited = std::visit([&](auto& shape) { return draw_fields(shape, actions); }, changed.shape);
    ImGui::PopID();
    if (const std::string details = shape_details(object.shape); !details.empty())
        ImGui::TextDisabled("%s", details.c_str());
    if (edited) editor.edit(SetObject{std::move(changed)}, fmt::format("Change {}", object.name));
}

/// The angles last typed for this rotation, or ones derived from it.
Vec3& euler_degrees(PanelState& state, const Quat& rotation) {
    if (state.euler.rotation != rotation) state.euler = {rotation, degrees_from_rotation(rotation)};
    return state.euler.degrees;
}

bool reset_button(const char* id, bool is_default, const char* tip) {
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    return icon_button(icon::kRestart, id, tip, !is_default);
}

bool draw_transform_fields(PanelState& state, Transform& transform, bool rigid) {
    const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
    bool changed = false;
    field_label("Move", "Translation in the space of the parent.");
    ImGui::SetNextItemWidth(-button);
    changed |= drag_vec3("translate", transform.translate, drag_speed(max_component(glm::abs(transform.translate))),
                         "%.4g", "translation in the space of the parent (G in the viewport)");
    if (reset_button("reset translate", transform.translate == Vec3(0), "Back to the origin.")) {
        transform.translate = Vec3(0);
        changed = true;
    }

    field_label("Rotate", "Degrees about x, then y, then z.");
    ImGui::SetNextItemWidth(-button);
    Vec3 degrees = euler_degrees(state, transform.rotate);
    if (drag_vec3("rotate", degrees, 0.5f, "%.4g\u00b0",
                  "degrees about this axis, x first, z last (R in the viewport)")) {
        transform.rotate = rotation_from_degrees(degrees);
        state.euler = {transform.rotate, degrees};
        changed = true;
    }
    if (reset_button("reset rotate", transform.rotate == Quat(1, 0, 0, 0), "Not rotated.")) {
        transform.rotate = Quat(1, 0, 0, 0);
        changed = true;
    }
    if (rigid) return changed;

    field_label("Scale", "Factor along each axis; negative mirrors.");
    ImGui::SetNextItemWidth(-button);
    Vec3 scale = transform.scale;
    if (drag_vec3("scale", scale, drag_speed(max_component(glm::abs(scale))), "%.4g",
                  "factor along this axis; with Shift all three together (S in the viewport)")) {
        const bool uniform = ImGui::GetIO().KeyShift && ImGui::IsMouseDown(ImGuiMouseButton_Left);
        for (int axis = 0; axis < 3 && uniform; ++axis) {
            if (scale[axis] == transform.scale[axis] || transform.scale[axis] == 0) continue;
            scale = transform.scale * (scale[axis] / transform.scale[axis]);
            break;
        }
        transform.scale = scale;
        changed = true;
    }
    if (reset_button("reset scale", transform.scale == Vec3(1), "Its own size.")) {
        transform.scale = Vec3(1);
        changed = true;
    }
    return changed;
}

bool draw_matrix(Transform& transform) {
    Mat4& matrix = *transform.matrix;
    bool changed = false;
    for (int row = 0; row < 3; ++row) {
        ImGui::PushID(row);
        field_label(row == 0 ? "Matrix" : "", "It shears, so it cannot be shown as move, rotate and scale.");
        Vec4 values(matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]);
        if (ImGui::DragFloat4("##row", &values.x, 0.005f, 0, 0, "%.4g")) {
            for (int column = 0; column < 4; ++column) matrix[column][row] = values[column];
            changed = true;
        }
        tooltip("A row of the matrix; the last number is the translation.");
        ImGui::PopID();
    }
    if (ImGui::Button("Remove the matrix", {-FLT_MIN, 0})) {
        transform = {};
        changed = true;
    }
    tooltip("Back to no transform at all.");
    return changed;
}

void draw_transform(Editor& editor, const Object& object) {
    Object changed = object;
    // A matrix that is a move, a rotation and a scale is shown as these; it stays a matrix until one is edited.
    if (object.transform.matrix) {
        if (auto parts = decomposed(object.transform.affine())) changed.transform = *parts;
    }
    ImGui::PushID("transform");
    const bool rigid = std::holds_alternative<Plane>(object.shape);
    const bool edited = changed.transform.matrix ? draw_matrix(changed.transform)
                                                 : draw_transform_fields(editor.panels, changed.transform, rigid);
    ImGui::PopID();
    if (edited) editor.edit(SetObject{std::move(changed)}, fmt::format("Transform {}", object.name));
}

void draw_environment(Editor& editor) {
    Environment environment = editor.scene().environment;
    ImGui::PushID("environment");
    bool edited = false;
    field_label("Kind", "What surrounds the scene and lights it from all sides.");
    if (ImGui::BeginCombo("##kind", std::string(type_label(environment)).c_str())) {
        for_each_type<Environment>([&]<typename T>() {
            const bool selected = std::holds_alternative<T>(environment);
            if (ImGui::Selectable(std::string(T::kLabel).c_str(), selected) && !selected) {
                if (needs_file<T>()) {
                    environment_dialog(editor);
                } else {
                    environment = T{};
                    edited = true;
                }
            }
            tooltip(T::kTip);
        });
        ImGui::EndCombo();
    }
    tooltip("What surrounds the scene and lights it from all sides.");
    const FieldActions actions{.browse_texture = {},
                               .browse_file = [&](std::string_view) { environment_dialog(editor); }};
    edited |= std::visit([&](auto& value) { return draw_fields(value, actions); }, environment);
    ImGui::PopID();
    if (edited) editor.edit(SetEnvironment{std::move(environment)}, "Change environment");
}

void draw_object(Editor& editor, ObjectId id) {
    draw_name(editor, *editor.scene().find(id));
    // Each part reads the object anew: the one before may have edited or removed it.
    const auto part = [&](const char* title, const char* tip, void (*draw)(Editor&, const Object&)) {
        const Object* object = editor.scene().find(id);
        if (!object || !section(title, tip)) return;
        const Object copy = *object;
        draw(editor, copy);
    };
    const Object* object = editor.scene().find(id);
    const bool is_list = object && std::holds_alternative<ObjectList>(object->shape);
    if (!is_list) part("Shape", "Its form in its own space.", draw_shape);
    part("Transform", "Where it stands, in the space of the list that holds it.", draw_transform);
    if (!is_list) part("Material", "What its surface is made of.", draw_object_material);
}

}  // namespace

void draw_inspector_panel(Editor& editor) {
    if (editor.selection && editor.scene().find(*editor.selection)) {
        ImGui::PushID("object");
        draw_object(editor, *editor.selection);
        ImGui::PopID();
    } else {
        hint("Nothing is selected. Click an object in the image or in the Scene panel to edit it.");
        ImGui::Spacing();
        if (section("Environment", "What surrounds the scene.")) draw_environment(editor);
    }
    if (section("Materials", "All materials of the scene.")) draw_material_list(editor);
}

}  // namespace rayuela
