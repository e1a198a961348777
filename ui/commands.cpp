#include "ui/commands.h"

#include "ui/camera_views.h"
#include "ui/file_actions.h"
#include "ui/object_actions.h"
#include "ui/panels/panels.h"
#include "ui/variants.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <vector>

namespace rayuela {
namespace {

constexpr int kCtrl = ImGuiMod_Ctrl, kShift = ImGuiMod_Shift, kAlt = ImGuiMod_Alt;

bool has_selection(const Editor& editor) {
    return editor.selection.has_value();
}

void add_file_commands(std::vector<Command>& list) {
    const auto restart_with_empty = [](Editor& editor) {
        editor.after_asking_to_save([](Editor& e) { e.new_scene(); });
    };
    list.push_back({"File", "New", "An empty scene under a sky.", kCtrl | ImGuiKey_N, 0, restart_with_empty});
    list.push_back({"File", "Open...", "Opens a scene, glTF, OBJ or PLY file.", kCtrl | ImGuiKey_O, 0, open_dialog});
    list.push_back(
        {"File", "Import...", "Adds a mesh or glTF file to the scene.", kCtrl | ImGuiKey_I, 0, import_dialog});
    list.push_back({.menu = "File",
                    .name = "Save",
                    .tip = "Saves the scene to its file.",
                    .shortcut = kCtrl | ImGuiKey_S,
                    .run = save_or_ask,
                    .starts_group = true});
    list.push_back(
        {"File", "Save as...", "Saves the scene to another file.", kCtrl | kShift | ImGuiKey_S, 0, save_as_dialog});
    list.push_back({.menu = "File",
                    .name = "Restore autosave",
                    .tip = "Opens what a session that ended without saving had autosaved.",
                    .run = [](Editor& editor) { editor.restore_lost_work(); },
                    .enabled = [](const Editor& editor) { return !editor.lost_work().empty(); }});
    list.push_back({"File", "Save image...", "PNG as it looks, or EXR, HDR, PFM with linear light.", ImGuiKey_F12, 0,
                    save_image_dialog});
    list.push_back({.menu = "File",
                    .name = "Quit",
                    .tip = "Ends the program; asks first if something is unsaved.",
                    .shortcut = kCtrl | ImGuiKey_Q,
                    .run = [](Editor& editor) { editor.request_quit(); },
                    .starts_group = true});
}

void add_edit_commands(std::vector<Command>& list) {
    list.push_back({.menu = "Edit",
                    .name = "Undo",
                    .tip = "Takes the last change back.",
                    .shortcut = kCtrl | ImGuiKey_Z,
                    .run = [](Editor& editor) { editor.undo(); },
                    .enabled = [](const Editor& editor) { return editor.can_undo(); },
                    .label = [](const Editor& editor) { return "Undo " + editor.undo_label(); }});
    list.push_back({.menu = "Edit",
                    .name = "Redo",
                    .tip = "Brings back what was undone.",
                    .shortcut = kCtrl | kShift | ImGuiKey_Z,
                    .alternative = kCtrl | ImGuiKey_Y,
                    .run = [](Editor& editor) { editor.redo(); },
                    .enabled = [](const Editor& editor) { return editor.can_redo(); },
                    .label = [](const Editor& editor) { return "Redo " + editor.redo_label(); }});
    list.push_back({.menu = "Edit",
                    .name = "Duplicate",
                    .tip = "Copies the selected object at its place.",
                    .shortcut = kCtrl | ImGuiKey_D,
                    .alternative = kShift | ImGuiKey_D,
                    .run = duplicate_selection,
                    .enabled = has_selection,
                    .starts_group = true});
    list.push_back({.menu = "Edit",
                    .name = "Delete",
                    .tip = "Removes the selected object.",
                    .shortcut = ImGuiKey_X,
                    .alternative = ImGuiKey_Delete,
                    .run = delete_selection,
                    .enabled = has_selection});
    list.push_back({.menu = "Edit",
                    .name = "Rename",
                    .tip = "Gives the selected object another name.",
                    .shortcut = ImGuiKey_F2,
                    .run =
                        [](Editor& editor) {
                            const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
                            if (object) editor.panels.begin_rename(object->id, object->name);
                        },
                    .enabled = has_selection});
    list.push_back({.menu = "Edit",
                    .name = "Hide or show",
                    .tip = "Hides the selected object, or shows it again.",
                    .shortcut = ImGuiKey_H,
                    .run =
                        [](Editor& editor) {
                            const Object* object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
                            if (object) set_visible(editor, object->id, !object->visible);
                        },
                    .enabled = has_selection});
    list.push_back({.menu = "Edit",
                    .name = "Select nothing",
                    .tip = "Shows the environment in the Inspector.",
                    .shortcut = kAlt | ImGuiKey_A,
                    .run = [](Editor& editor) { editor.selection.reset(); },
                    .enabled = has_selection});
}

void add_add_commands(std::vector<Command>& list) {
    for_each_type<Shape>([&]<typename T>() {
        list.push_back(
            {"Add", T::kLabel.data(), T::kTip.data(), 0, 0, [](Editor& editor) { add_object(editor, T{}); }});
    });
    for_each_type<Material>([&]<typename T>() {
        static const std::string kName = "Material: " + std::string(T::kLabel);
        list.push_back({.menu = "Add",
                        .name = kName.c_str(),
                        .tip = T::kTip.data(),
                        .run = [](Editor& editor) { add_material(editor, std::string(T::kLabel), T{}); },
                        .starts_group = std::is_same_v<T, std::variant_alternative_t<0, Material>>});
    });
}

void add_gizmo_command(std::vector<Command>& list, const char* name, const char* tip, int shortcut, GizmoMode mode) {
    list.push_back({.menu = "View",
                    .name = name,
                    .tip = tip,
                    .shortcut = shortcut,
                    .run = [mode](Editor& editor) { editor.view.gizmo = mode; },
                    .checked = [mode](const Editor& editor) { return editor.view.gizmo == mode; },
                    .starts_group = mode == GizmoMode::none});
}

void add_view_commands(std::vector<Command>& list) {
    list.push_back({.menu = "View",
                    .name = "Frame selected",
                    .tip = "Moves the camera so that the selected object fills the view.",
                    .shortcut = ImGuiKey_F,
                    .alternative = ImGuiKey_KeypadDecimal,
                    .run = [](Editor& editor) { frame_bounds_of(editor, editor.selection); }});
    list.push_back({"View", "Frame all", "Moves the camera so that everything is in view.", ImGuiKey_Home, 0,
                    [](Editor& editor) { frame_bounds_of(editor, {}); }});
    static constexpr int kViewKeys[] = {ImGuiKey_Keypad1,         kCtrl | ImGuiKey_Keypad1, ImGuiKey_Keypad3,
                                        kCtrl | ImGuiKey_Keypad3, ImGuiKey_Keypad7,         kCtrl | ImGuiKey_Keypad7};
    for (std::size_t i = 0; i < axis_views().size(); ++i) {
        const AxisView& view = axis_views()[i];
        list.push_back(
            {"View", view.name, "Looks at the target along an axis.", kViewKeys[i], 0, [view](Editor& editor) {
                 editor.edit(SetCamera{looking_along(editor.scene().camera, view)}, std::string(view.name) + " view");
             }});
    }
    add_gizmo_command(list, "No gizmo", "Only selects.", ImGuiKey_Q, GizmoMode::none);
    add_gizmo_command(list, "Move", "Handles in the image to move the selected object.", ImGuiKey_G,
                      GizmoMode::translate);
    add_gizmo_command(list, "Rotate", "Handles in the image to rotate the selected object.", ImGuiKey_R,
                      GizmoMode::rotate);
    add_gizmo_command(list, "Scale", "Handles in the image to scale the selected object.", ImGuiKey_S,
                      GizmoMode::scale);

    list.push_back({.menu = "View",
                    .name = "Fit",
                    .tip = "Scales the image to the viewport.",
                    .shortcut = kShift | ImGuiKey_F,
                    .run = [](Editor& editor) { editor.view.fit = true; },
                    .checked = [](const Editor& editor) { return editor.view.fit; },
                    .starts_group = true});
    list.push_back({"View", "Actual size", "One pixel of the image is one of the display.", kCtrl | ImGuiKey_1, 0,
                    [](Editor& editor) {
                        editor.view.fit = false;
                        editor.view.zoom = 1;
                        editor.view.pan_x = editor.view.pan_y = 0;
                    }});
    list.push_back({.menu = "View",
                    .name = "Match window",
                    .tip = "The image takes the size of the viewport.",
                    .run = [](Editor& editor) { editor.view.match_window = !editor.view.match_window; },
                    .checked = [](const Editor& editor) { return editor.view.match_window; }});
    list.push_back({"View", "Brighter", "Half a stop more exposure; nothing is rendered anew.", ImGuiKey_Equal,
                    ImGuiKey_KeypadAdd, [](Editor& editor) { editor.view.exposure += 0.5f; }});
    list.push_back({"View", "Darker", "Half a stop less exposure; nothing is rendered anew.", ImGuiKey_Minus,
                    ImGuiKey_KeypadSubtract, [](Editor& editor) { editor.view.exposure -= 0.5f; }});
    list.push_back(
        {"View", "Normal exposure", "Exposure 0.", ImGuiKey_0, 0, [](Editor& editor) { editor.view.exposure = 0; }});
    list.push_back({"View", "Next tone map", "Linear, ACES, AgX, Filmic, false color, and around.", ImGuiKey_T, 0,
                    [](Editor& editor) {
                        const auto next =
                            (static_cast<std::size_t>(editor.view.tone_map) + 1) % std::size(kToneMapNames);
                        editor.view.tone_map = static_cast<ToneMap>(next);
                        editor.view.map = ViewMap::image;
                    }});
    for (std::size_t i = 0; i < std::size(kViewMaps); ++i) {
        const auto map = static_cast<ViewMap>(i);
        list.push_back({.menu = "View",
                        .name = kViewMaps[i].name,
                        .tip = kViewMaps[i].tip,
                        .run = [map](Editor& editor) { editor.view.map = map; },
                        .checked = [map](const Editor& editor) { return editor.view.map == map; },
                        .starts_group = i == 0});
    }
    list.push_back({.menu = "View",
                    .name = "Outline",
                    .tip = "Marks the selected object in the image.",
                    .run = [](Editor& editor) { editor.view.show_outline = !editor.view.show_outline; },
                    .checked = [](const Editor& editor) { return editor.view.show_outline; },
                    .starts_group = true});
    for (std::size_t i = 0; i < kPanels.size(); ++i) {
        static_assert(kPanels.size() <= std::tuple_size_v<decltype(PanelState::closed)>);
        list.push_back({.menu = "View",
                        .name = kPanels[i].name,
                        .tip = kPanels[i].tip,
                        .run = [i](Editor& editor) { editor.panels.closed[i] = !editor.panels.closed[i]; },
                        .checked = [i](const Editor& editor) { return !editor.panels.closed[i]; },
                        .starts_group = i == 0});
    }
    list.push_back({"View", "Reset layout", "All panels back in their first places.", 0, 0, [](Editor& editor) {
                        editor.panels.closed = {};
                        editor.view.reset_layout = true;
                    }});
}

void change_accelerator(Editor& editor, AccelSettings accel) {
    RenderSettings render = editor.scene().render;
    render.accel = accel;
    editor.edit(SetRenderSettings{render}, "Change structure");
}

void add_render_commands(std::vector<Command>& list) {
    list.push_back({.menu = "Render",
                    .name = "Pause",
                    .tip = "Stops adding samples, or goes on.",
                    .shortcut = ImGuiKey_P,
                    .alternative = ImGuiKey_Pause,
                    .run = [](Editor& editor) { editor.paused = !editor.paused; },
                    .checked = [](const Editor& editor) { return editor.paused; }});
    list.push_back({"Render", "Restart", "Throws the samples away and starts anew.", kCtrl | ImGuiKey_R, 0,
                    [](Editor& editor) { editor.session().restart(); }});
    list.push_back(
        {.menu = "Render",
         .name = "Use the kd-tree",
         .tip = "Switches between kd-tree and list; the image stays the same.",
         .shortcut = ImGuiKey_K,
         .run =
             [](Editor& editor) {
                 AccelSettings accel = editor.scene().render.accel;
                 const bool tree = accel.kind == AcceleratorKind::kd;
                 accel.kind = tree ? AcceleratorKind::list : AcceleratorKind::kd;
                 change_accelerator(editor, accel);
             },
         .checked = [](const Editor& editor) { return editor.scene().render.accel.kind == AcceleratorKind::kd; },
         .starts_group = true});
    list.push_back({"Render", "Larger leaves", "Doubles the leaf size.", ImGuiKey_RightBracket, 0, [](Editor& editor) {
                        AccelSettings accel = editor.scene().render.accel;
                        accel.leaf_size = std::min(2 * accel.leaf_size, kMaxLeafSize);
                        change_accelerator(editor, accel);
                    }});
    list.push_back({"Render", "Smaller leaves", "Halves the leaf size.", ImGuiKey_LeftBracket, 0, [](Editor& editor) {
                        AccelSettings accel = editor.scene().render.accel;
                        accel.leaf_size = std::max(accel.leaf_size / 2, kMinLeafSize);
                        change_accelerator(editor, accel);
                    }});
}

void add_help_commands(std::vector<Command>& list) {
    const auto toggle = [&](const char* name, const char* tip, int shortcut, bool PanelState::*shown) {
        list.push_back({.menu = "Help",
                        .name = name,
                        .tip = tip,
                        .shortcut = shortcut,
                        .run = [shown](Editor& editor) { editor.panels.*shown = !(editor.panels.*shown); },
                        .checked = [shown](const Editor& editor) { return editor.panels.*shown; }});
    };
    toggle("Quick start", "The first steps on one page.", 0, &PanelState::show_quick_start);
    toggle("Shortcuts", "All commands and their keys.", ImGuiKey_F1, &PanelState::show_shortcuts);
    toggle("About", "What this program is.", 0, &PanelState::show_about);
}

std::vector<Command> make_commands() {
    std::vector<Command> list;
    add_file_commands(list);
    add_edit_commands(list);
    add_add_commands(list);
    add_view_commands(list);
    add_render_commands(list);
    add_help_commands(list);
    return list;
}

}  // namespace

std::span<const Command> commands() {
    static const std::vector<Command> kCommands = make_commands();
    return kCommands;
}

const Command* find_command(std::string_view name) {
    const auto found =
        std::ranges::find(commands(), name, [](const Command& command) { return std::string_view(command.name); });
    return found != commands().end() ? &*found : nullptr;
}

void run(const Command& command, Editor& editor) {
    if (!command.enabled || command.enabled(editor)) command.run(editor);
}

std::string shortcut_text(int shortcut) {
    return shortcut ? ImGui::GetKeyChordName(shortcut) : "";
}

}  // namespace rayuela
