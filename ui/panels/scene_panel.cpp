#include "ui/icons.h"
#include "ui/object_actions.h"
#include "ui/panels/panels.h"
#include "ui/variants.h"
#include "ui/widgets.h"

#include <fmt/format.h>
#include <misc/cpp/imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <unordered_map>

namespace rayuela {
namespace {

constexpr const char* kPayload = "rayuela object";

struct Row {
    const Object* object;
    int depth;
    bool has_children;
};

/// The text, cut so that it is at most so wide.
std::string ellipsized(const std::string& text, float width) {
    if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
    std::string cut = text;
    while (!cut.empty() && ImGui::CalcTextSize((cut + "\u2026").c_str()).x > width) {
        do {
            cut.pop_back();
        } while (!cut.empty() && (cut.back() & 0xc0) == 0x80);
        // What is left of a multi-byte character goes with its first byte.
        if (!cut.empty() && (static_cast<unsigned char>(cut.back()) >= 0xc0)) cut.pop_back();
    }
    return cut + "\u2026";
}

bool contains_ignoring_case(std::string_view text, std::string_view part) {
    const auto equal = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), equal) != text.end();
}

/// The tree from top to bottom without what is folded away; with a filter, all that matches, flat.
std::vector<Row> visible_rows(const Scene& scene, const PanelState& state) {
    std::vector<Row> rows;
    if (!state.scene_filter.empty()) {
        for (const Object& object : scene.objects) {
            if (contains_ignoring_case(object.name, state.scene_filter)) rows.push_back({&object, 0, false});
        }
        return rows;
    }
    std::unordered_map<ObjectId, std::vector<const Object*>> children;
    for (const Object& object : scene.objects) children[object.parent].push_back(&object);
    const auto visit = [&](const auto& self, ObjectId parent, int depth) -> void {
        const auto found = children.find(parent);
        if (found == children.end()) return;
        for (const Object* object : found->second) {
            rows.push_back({object, depth, children.contains(object->id)});
            if (!state.collapsed.contains(object->id)) self(self, object->id, depth + 1);
        }
    };
    visit(visit, ObjectId{}, 0);
    return rows;
}

void draw_add_menu(Editor& editor) {
    for_each_type<Shape>([&]<typename T>() {
        const T shape{};
        const std::string label =
            fmt::format("{}  {}{}###{}", shape_icon(shape), T::kLabel, needs_file<T>() ? "..." : "", T::kType);
        if (ImGui::MenuItem(label.c_str())) add_object(editor, shape);
        tooltip(T::kTip);
    });
}

void draw_header(Editor& editor) {
    ImGui::SetNextItemWidth(-ImGui::GetFrameHeight() - ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::InputTextWithHint("##filter", fmt::format("{}  Search", icon::kSearch).c_str(), &editor.panels.scene_filter);
    tooltip("Shows only objects whose name contains this.");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(icon::kAdd, "add", "Add an object where the camera looks.")) ImGui::OpenPopup("add object");
    if (ImGui::BeginPopup("add object")) {
        draw_add_menu(editor);
        ImGui::EndPopup();
    }
}

void draw_context_menu(Editor& editor, const Object& object) {
    const ObjectId id = object.id;
    if (!ImGui::BeginPopupContextItem("object menu")) return;
    editor.selection = id;
    const auto item = [](const char* label, const char* shortcut, const char* tip) {
        const bool pressed = ImGui::MenuItem(label, shortcut);
        tooltip(tip);
        return pressed;
    };
    const bool visible = object.visible;
    const bool in_list = static_cast<bool>(object.parent);
    if (item("Frame", "F", "Moves the camera so that the object fills the view.")) frame_bounds_of(editor, id);
    if (item("Rename", "F2", "Gives it another name.")) editor.panels.begin_rename(id, object.name);
    if (item(visible ? "Hide" : "Show", "H", "Hidden objects are not rendered.")) set_visible(editor, id, !visible);
    if (item("Duplicate", "Ctrl+D", "Makes a copy at the same place.")) duplicate_selection(editor);
    if (in_list && item("Move out of the list", nullptr, "To the top level; it keeps its place."))
        move_into(editor, id, {});
    ImGui::Separator();
    if (item("Delete", "X", "Removes it; undo brings it back.")) delete_selection(editor);
    ImGui::EndPopup();
}

void draw_rename_field(Editor& editor, ObjectId id) {
    PanelState& state = editor.panels;
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (!state.rename_started) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##rename", &state.new_name,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    tooltip("Enter keeps the new name, Escape the old one.");
    const bool left = state.rename_started && !ImGui::IsItemActive();
    const bool escaped = ImGui::IsKeyPressed(ImGuiKey_Escape);
    if (ImGui::IsItemActive()) state.rename_started = true;
    if (!entered && !left) return;
    if (!escaped && !state.new_name.empty()) rename_object(editor, id, state.new_name);
    state.renaming = {};
}

void drag_and_drop(Editor& editor, const Object& object) {
    if (ImGui::BeginDragDropSource()) {
        ImGui::SetDragDropPayload(kPayload, &object.id, sizeof object.id);
        ImGui::Text("%s  %s", shape_icon(object.shape), object.name.c_str());
        ImGui::EndDragDropSource();
    }
    if (!std::holds_alternative<ObjectList>(object.shape) || !ImGui::BeginDragDropTarget()) return;
    if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload(kPayload)) {
        move_into(editor, *static_cast<const ObjectId*>(payload->Data), object.id);
    }
    ImGui::EndDragDropTarget();
}

float row_end_width() {
    return 1.5f * ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().ItemInnerSpacing.x;
}

/// Swatch of the material and eye at the right end of a row.
void draw_row_end(Editor& editor, const Object& object) {
    const float button = ImGui::GetFrameHeight(), spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const MaterialEntry* material = editor.scene().find(object.material);
    if (material) {
        const float swatch = 0.5f * button;
        ImGui::SameLine(ImGui::GetContentRegionMax().x - button - swatch - spacing);
        ImGui::SetCursorPosY(ImGui::GetCursorPosY() + 0.25f * button);
        ImGui::ColorButton("##material", display_color(swatch_color(material->material)),
                           ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {swatch, swatch});
        tooltip(fmt::format("Material: {} ({})", material->name, type_label(material->material)));
    }
    ImGui::SameLine(ImGui::GetContentRegionMax().x - button);
    ImGui::PushStyleColor(ImGuiCol_Button, 0);
    if (!object.visible) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const bool pressed = icon_button(object.visible ? icon::kVisible : icon::kHidden, "visible",
                                     object.visible ? "Hide: it will not be rendered (H)." : "Show it again (H).");
    if (!object.visible) ImGui::PopStyleColor();
    ImGui::PopStyleColor();
    if (pressed) set_visible(editor, object.id, !object.visible);
}

void draw_row(Editor& editor, const Row& row) {
    // A copy: an edit below replaces the scene that the row points into.
    const Object object = *row.object;
    PanelState& state = editor.panels;
    ImGui::PushID(static_cast<int>(object.id.value));
    const float indent = static_cast<float>(row.depth) * ImGui::GetStyle().IndentSpacing;
    if (indent > 0) ImGui::Indent(indent);

    if (state.renaming == object.id) {
        draw_rename_field(editor, object.id);
    } else {
        ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_FramePadding |
                                   ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_OpenOnArrow |
                                   ImGuiTreeNodeFlags_AllowOverlap;
        if (!row.has_children) flags |= ImGuiTreeNodeFlags_Leaf;
        if (editor.selection == object.id) flags |= ImGuiTreeNodeFlags_Selected;
        const bool shown = editor.scene().is_visible(object.id);
        if (!shown) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::SetNextItemOpen(!state.collapsed.contains(object.id));
        const float room = ImGui::GetContentRegionAvail().x - ImGui::GetTreeNodeToLabelSpacing() - row_end_width();
        const std::string label = ellipsized(fmt::format("{}  {}", shape_icon(object.shape), object.name), room);
        ImGui::TreeNodeEx((label + "###object").c_str(), flags);
        if (!shown) ImGui::PopStyleColor();
        if (ImGui::IsItemToggledOpen()) {
            if (state.collapsed.erase(object.id) == 0) state.collapsed.insert(object.id);
        } else if (ImGui::IsItemClicked()) {
            editor.selection = object.id;
        }
        if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
            state.begin_rename(object.id, object.name);
        tooltip(fmt::format("{}: {}\nClick selects, double-click renames; drag onto a list to put it there.",
                            object.name, type_label(object.shape)));
        drag_and_drop(editor, object);
        draw_context_menu(editor, object);
        if (editor.scene().find(object.id)) draw_row_end(editor, object);
    }
    if (indent > 0) ImGui::Unindent(indent);
    ImGui::PopID();
}

void draw_empty_state(Editor& editor) {
    ImGui::Spacing();
    hint("Nothing here yet. Add a first object, open a scene from the File menu, or drop a file onto the window.");
    ImGui::Spacing();
    for_each_type<Shape>([&]<typename T>() {
        const T shape{};
        const std::string label =
            fmt::format("{}  {}{}###first {}", shape_icon(shape), T::kLabel, needs_file<T>() ? "..." : "", T::kType);
        if (ImGui::Button(label.c_str(), {-FLT_MIN, 0})) add_object(editor, shape);
        tooltip(T::kTip);
    });
}

}  // namespace

void draw_scene_panel(Editor& editor) {
    draw_header(editor);
    if (ImGui::BeginChild("objects")) {
        // Rows point into the scene; the snapshot holds it while edits replace it.
        const std::shared_ptr<const Scene> scene = editor.snapshot();
        const std::vector<Row> rows = visible_rows(*scene, editor.panels);
        if (scene->objects.empty()) {
            draw_empty_state(editor);
        } else if (rows.empty()) {
            hint("No name contains the text above.");
        }
        ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 1});
        ImGuiListClipper clipper;
        clipper.Begin(static_cast<int>(rows.size()));
        while (clipper.Step()) {
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
                draw_row(editor, rows[static_cast<std::size_t>(i)]);
        }
        ImGui::PopStyleVar();

        // The empty space below: a click there selects nothing, an object dropped there goes to the top level.
        const ImVec2 rest = ImGui::GetContentRegionAvail();
        if (!rows.empty() && rest.y > 1) {
            if (ImGui::InvisibleButton("##nothing", {std::max(rest.x, 1.0f), rest.y})) editor.selection.reset();
            if (ImGui::BeginDragDropTarget()) {
                if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload(kPayload)) {
                    move_into(editor, *static_cast<const ObjectId*>(payload->Data), {});
                }
                ImGui::EndDragDropTarget();
            }
        }
    }
    ImGui::EndChild();
}

}  // namespace rayuela
