#include "ui/dialogs.h"

#include "ui/assets_path.h"
#include "ui/commands.h"
#include "ui/file_actions.h"
#include "ui/icons.h"
#include "ui/widgets.h"

#include <fmt/format.h>

namespace rayuela {
namespace {

void place_in_center(float width, float height) {
    const float font = ImGui::GetFontSize();
    const ImVec2 window = ImGui::GetMainViewport()->WorkSize;
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(width * font, 0.95f * window.x), std::min(height * font, 0.92f * window.y)},
                             ImGuiCond_Appearing);
}

constexpr ImGuiWindowFlags kWindowFlags =
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoDocking | ImGuiWindowFlags_NoSavedSettings;

bool button(const char* label, const char* tip, float width) {
    const bool pressed = ImGui::Button(label, {width * ImGui::GetFontSize(), 0});
    tooltip(tip);
    return pressed;
}

void draw_unsaved_question(Editor& editor) {
    constexpr const char* kTitle = "Save changes?";
    if (editor.unsaved_action && !ImGui::IsPopupOpen(kTitle) && !editor.file_dialog.is_open()) ImGui::OpenPopup(kTitle);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings))
        return;
    ImGui::TextUnformatted(fmt::format("{} has changes that are not saved.", editor.title()).c_str());
    ImGui::Spacing();
    const std::function<void(Editor&)> action = editor.unsaved_action;
    const bool save = button("Save", "Saves the scene, then goes on.", 7);
    ImGui::SameLine();
    const bool discard = button("Don't save", "Goes on; the changes are lost.", 7);
    ImGui::SameLine();
    const bool cancel = button("Cancel", "Stays here (Escape).", 7) || ImGui::IsKeyPressed(ImGuiKey_Escape);
    if (save || discard || cancel) {
        editor.unsaved_action = nullptr;
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
    if (save) save_and_then(editor, action);
    if (discard) action(editor);
}

void draw_lost_work(Editor& editor) {
    constexpr const char* kTitle = "Restore?";
    bool& show = editor.panels.show_lost_work;
    if (show && !ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings))
        return;
    ImGui::TextUnformatted("Rayuela ended without saving the last time.");
    hint("File > Restore autosave brings it back later, too.");
    ImGui::Spacing();
    const bool restore = button("Restore", "Opens what was autosaved, as an unsaved scene.", 7);
    ImGui::SameLine();
    const bool go_on = button("Not now", "Goes on without it (Escape).", 7) || ImGui::IsKeyPressed(ImGuiKey_Escape);
    if (restore || go_on) {
        show = false;
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
    if (restore) editor.restore_lost_work();
}

void draw_shortcut_table(const char* menu) {
    ImGui::SeparatorText(menu);
    if (!ImGui::BeginTable(menu, 3, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("tip", ImGuiTableColumnFlags_WidthStretch, 2.4f);
    for (const Command& command : commands()) {
        if (command.menu != std::string_view(menu)) continue;
        std::string keys = shortcut_text(command.shortcut);
        if (command.alternative) keys += ", " + shortcut_text(command.alternative);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(command.name);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(keys.c_str());
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", command.tip);
    }
    ImGui::EndTable();
}

struct MouseHelp {
    const char* action;
    const char* effect;
};
constexpr MouseHelp kMouseHelp[] = {
    {"Left drag", "Orbit around the target"},
    {"Middle drag, or shift + left drag", "Pan"},
    {"Wheel", "Move closer or away"},
    {"Right button + W A S D, Q E", "Fly; the mouse looks around"},
    {"Click", "Select an object"},
    {"Double-click", "Make that point sharp"},
    {"Ctrl + wheel", "Zoom into the pixels"},
    {"Drag a number; ctrl-click it", "Change it; type it"},
    {"Right click a control", "Back to its default"},
};

void draw_mouse_table() {
    ImGui::SeparatorText("Mouse");
    if (!ImGui::BeginTable("mouse", 2, ImGuiTableFlags_RowBg)) return;
    for (const MouseHelp& help : kMouseHelp) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(help.action);
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", help.effect);
    }
    ImGui::EndTable();
}

void draw_shortcuts(Editor& editor) {
    if (!editor.panels.show_shortcuts) return;
    place_in_center(54, 40);
    if (ImGui::Begin("Shortcuts", &editor.panels.show_shortcuts, kWindowFlags)) {
        draw_mouse_table();
        for (const char* menu : kMenus) draw_shortcut_table(menu);
    }
    ImGui::End();
}

void draw_quick_start(Editor& editor) {
    if (!editor.panels.show_quick_start) return;
    place_in_center(38, 32);
    if (ImGui::Begin("Quick start", &editor.panels.show_quick_start, kWindowFlags)) {
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted(
            "Rayuela shows a scene as light would draw it. The image starts noisy and clears by itself while you look, "
            "and while you edit.");
        const auto step = [](const char* symbol, const char* text) {
            ImGui::Spacing();
            ImGui::TextUnformatted(symbol);
            ImGui::SameLine(2.2f * ImGui::GetFontSize());
            ImGui::TextUnformatted(text);
        };
        step(icon::kOpen, "Open one of the examples below, or drop a scene, glTF, OBJ or PLY file onto the window.");
        step(icon::kFrame,
             "Drag in the image to orbit, turn the wheel to come closer, press F to frame what is selected.");
        step(icon::kBox,
             "Click an object and change it in the Inspector: form, place and material. Ctrl+Z takes anything back.");
        step(icon::kAdd, "Add objects with the + of the Scene panel.");
        step(icon::kMesh,
             "Render has the acceleration structure: move the leaf size and watch nodes and speed in Statistics. The "
             "image stays the same.");
        step(icon::kImage, "F12 saves the image, Ctrl+S the scene, F1 lists all keys.");
        ImGui::PopTextWrapPos();
        ImGui::SeparatorText("Examples");
        const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemInnerSpacing.x) / 3;
        int index = 0;
        for (const Example& example : example_scenes()) {
            if (index++ % 3 != 0) ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
            if (ImGui::Button(example.name.c_str(), {width, 0})) {
                editor.after_asking_to_save([file = example.file](Editor& e) { e.open(file); });
                editor.panels.show_quick_start = false;
            }
            tooltip(example.description.empty() ? example.name : example.description);
        }
    }
    ImGui::End();
}

void draw_about(Editor& editor) {
    if (!editor.panels.show_about) return;
    place_in_center(30, 14);
    if (ImGui::Begin("About", &editor.panels.show_about, kWindowFlags)) {
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted("Rayuela, an interactive progressive path tracer on the CPU.");
        ImGui::Spacing();
        ImGui::TextUnformatted(
            "Its image does not depend on the number of threads, on the acceleration structure or on its leaf size; "
            "samples that make no sense are counted and shown, never hidden.");
        ImGui::Spacing();
        hint(
            "With Dear ImGui, ImPlot, ImGuizmo, GLFW, GLM, Highway, oneTBB, OpenEXR, tinygltf, stb; fonts Inter, "
            "JetBrains Mono "
            "and Font Awesome.");
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

}  // namespace

void draw_dialogs(Editor& editor) {
    draw_quick_start(editor);
    draw_shortcuts(editor);
    draw_about(editor);
    draw_lost_work(editor);
    draw_unsaved_question(editor);
    draw_file_dialog(editor);
}

}  // namespace rayuela
