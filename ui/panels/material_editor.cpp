#include "ui/panels/material_editor.h"

#include "ui/file_actions.h"
#include "ui/icons.h"
#include "ui/object_actions.h"
#include "ui/variants.h"
#include "ui/widgets.h"

#include <fmt/format.h>
#include <misc/cpp/imgui_stdlib.h>

namespace rayuela {
namespace {

void swatch(const Material& material) {
    const float side = ImGui::GetTextLineHeight();
    ImGui::ColorButton("##swatch", display_color(swatch_color(material)),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {side, side});
    tooltip(type_label(material));
}

void draw_type(Editor& editor, const MaterialEntry& entry) {
    field_label("Kind", "How the surface treats light.");
    if (!ImGui::BeginCombo("##kind", std::string(type_label(entry.material)).c_str())) {
        tooltip("How the surface treats light. What both kinds have in common is kept.");
        return;
    }
    for_each_type<Material>([&]<typename T>() {
        const bool selected = std::holds_alternative<T>(entry.material);
        if (ImGui::Selectable(std::string(T::kLabel).c_str(), selected) && !selected) {
            editor.edit(SetMaterial{{entry.id, entry.name, converted<T>(entry.material)}},
                        fmt::format("Make {} {}", entry.name, T::kLabel));
        }
        tooltip(T::kTip);
    });
    ImGui::EndCombo();
}

/// Name, kind and fields of one material.
void draw_material(Editor& editor, const MaterialEntry& entry) {
    ImGui::PushID("material");
    field_label("Name", "Name of the material.");
    MaterialEntry changed = entry;
    const bool renamed = ImGui::InputText("##name", &changed.name);
    // Names on the way to the wanted one may be empty or taken.
    if (renamed && !changed.name.empty() && !editor.scene().find_material(changed.name)) {
        editor.edit(SetMaterial{changed}, "Rename material");
    }
    tooltip("Name of the material; unique in the scene.");
    draw_type(editor, entry);

    const MaterialId id = entry.id;
    const FieldActions actions{
        .browse_texture = [&editor, id](std::string_view key) { texture_dialog(editor, id, std::string(key)); },
        .browse_file = {}};
    changed = entry;
    if (std::visit([&](auto& material) { return draw_fields(material, actions); }, changed.material)) {
        editor.edit(SetMaterial{std::move(changed)}, fmt::format("Change {}", entry.name));
    }
    ImGui::PopID();
}

void draw_assignment(Editor& editor, const Object& object) {
    const Scene& scene = editor.scene();
    const MaterialEntry* current = scene.find(object.material);
    const bool is_gltf = std::holds_alternative<Gltf>(object.shape);
    const char* none = is_gltf ? "The file's own" : "Default grey";
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::SetNextItemWidth(-2 * (ImGui::GetFrameHeight() + spacing));
    if (ImGui::BeginCombo("##assign", current ? current->name.c_str() : none)) {
        if (ImGui::Selectable(none, !current)) assign_material(editor, object.id, {});
        tooltip(is_gltf ? "Each part keeps the material that its file gives it."
                        : "A plain diffuse grey that is no part of the scene.");
        const std::vector<MaterialEntry> materials = scene.materials;
        for (const MaterialEntry& entry : materials) {
            ImGui::PushID(static_cast<int>(entry.id.value));
            swatch(entry.material);
            ImGui::SameLine();
            if (ImGui::Selectable(entry.name.c_str(), entry.id == object.material))
                assign_material(editor, object.id, entry.id);
            tooltip(fmt::format("{}, used by {}", type_label(entry.material), user_count(scene, entry.id)));
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    tooltip("The material that this object is made of.");
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kAdd, "new", "Give it a new material.")) add_material(editor, object.name, Diffuse{});
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kCopy, "copy", "Give it a copy, so that others who use this material stay as they are.",
                    current) &&
        current) {
        add_material(editor, current->name, current->material);
    }
}

void draw_list_buttons(Editor& editor) {
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    if (icon_button(icon::kAdd, "add", "Add a material to the scene.")) {
        editor.selection.reset();
        add_material(editor, "Material", Diffuse{});
    }
    const MaterialEntry* selected = editor.selected_material ? editor.scene().find(*editor.selected_material) : nullptr;
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kCopy, "copy", "Copy the selected material.", selected) && selected) {
        const MaterialId copy{editor.scene().next_id};
        if (editor.edit(AddMaterial{selected->name, selected->material}, "Copy material"))
            editor.selected_material = copy;
    }
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kDelete, "remove", "Remove the selected material; its users become default grey.",
                    selected) &&
        selected) {
        editor.edit(RemoveMaterial{selected->id}, "Remove " + selected->name);
    }
    const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    if (!object) return;
    ImGui::SameLine(0, spacing);
    selected = editor.selected_material ? editor.scene().find(*editor.selected_material) : nullptr;
    ImGui::BeginDisabled(!selected || selected->id == object->material);
    if (ImGui::Button("Assign") && selected) assign_material(editor, object->id, selected->id);
    ImGui::EndDisabled();
    tooltip("Gives the selected material to the selected object.");
}

}  // namespace

void draw_object_material(Editor& editor, const Object& object) {
    ImGui::PushID("assignment");
    draw_assignment(editor, object);
    ImGui::PopID();
    const Object* now = editor.scene().find(object.id);
    const MaterialEntry* material = now ? editor.scene().find(now->material) : nullptr;
    if (!material) return;
    const int users = user_count(editor.scene(), material->id);
    if (users > 1) ImGui::TextDisabled("Shared by %d objects: a change shows on all.", users);
    const MaterialEntry copy = *material;
    draw_material(editor, copy);
}

void draw_material_list(Editor& editor) {
    ImGui::PushID("materials");
    draw_list_buttons(editor);
    const std::shared_ptr<const Scene> scene = editor.snapshot();
    if (scene->materials.empty()) hint("No materials yet: objects are default grey.");
    for (const MaterialEntry& entry : scene->materials) {
        ImGui::PushID(static_cast<int>(entry.id.value));
        swatch(entry.material);
        ImGui::SameLine();
        const int users = user_count(*scene, entry.id);
        const std::string count = users > 0 ? std::to_string(users) : "unused";
        const float right = ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(count.c_str()).x;
        if (ImGui::Selectable(fmt::format("{}###material", entry.name).c_str(), editor.selected_material == entry.id)) {
            editor.selected_material = entry.id;
        }
        tooltip(fmt::format("{}, used by {} object{}", type_label(entry.material), users, users == 1 ? "" : "s"));
        ImGui::SameLine(right);
        ImGui::TextDisabled("%s", count.c_str());
        ImGui::PopID();
    }
    const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    const MaterialEntry* selected = editor.selected_material ? editor.scene().find(*editor.selected_material) : nullptr;
    // The selected object's own material is being shown above already.
    if (selected && !(object && object->material == selected->id)) {
        ImGui::SeparatorText(selected->name.c_str());
        const MaterialEntry copy = *selected;
        draw_material(editor, copy);
    }
    ImGui::PopID();
}

}  // namespace rayuela
