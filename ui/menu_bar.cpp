#include "ui/assets_path.h"
#include "ui/commands.h"
#include "ui/dialogs.h"
#include "ui/icons.h"
#include "ui/panels/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayuela {
namespace {

void open_after_asking(Editor& editor, const std::filesystem::path& file) {
    editor.after_asking_to_save([file](Editor& e) { e.open(file); });
}

void draw_recent_files(Editor& editor) {
    const std::vector<std::string> files = editor.preferences.recent_files;
    if (!ImGui::BeginMenu("Open recent", !files.empty())) return;
    for (const std::string& file : files) {
        const std::filesystem::path path(file);
        if (ImGui::MenuItem(fmt::format("{}###{}", path.filename().string(), file).c_str()))
            open_after_asking(editor, path);
        tooltip(file);
    }
    ImGui::EndMenu();
}

void draw_examples(Editor& editor) {
    if (!ImGui::BeginMenu("Examples")) return;
    const std::vector<Example> examples = example_scenes();
    for (const Example& example : examples) {
        if (ImGui::MenuItem(example.name.c_str())) open_after_asking(editor, example.file);
        tooltip(example.description.empty() ? example.name : example.description);
    }
    if (examples.empty()) hint("The folder of examples is missing.");
    ImGui::EndMenu();
}

void draw_command(Editor& editor, const Command& command) {
    if (command.starts_group) ImGui::Separator();
    const std::string label = command.label ? command.label(editor) : command.name;
    const bool enabled = !command.enabled || command.enabled(editor);
    const bool checked = command.checked && command.checked(editor);
    const bool pressed = ImGui::MenuItem(fmt::format("{}###{}", label, command.name).c_str(),
                                         shortcut_text(command.shortcut).c_str(), checked, enabled);
    tooltip(command.tip);
    if (pressed) command.run(editor);
}

void draw_menu(Editor& editor, std::string_view menu) {
    for (const Command& command : commands()) {
        if (command.menu != menu) continue;
        draw_command(editor, command);
        if (command.name == std::string_view("Open...")) {
            draw_recent_files(editor);
            draw_examples(editor);
        }
    }
}

/// Right end of the bar: what is being loaded, the last error, the name of the scene.
void draw_status(Editor& editor) {
    const std::string title = editor.title() + (editor.is_modified() ? " \u2022" : "");
    std::string message, tip;
    Vec4 color = theme::kMuted;
    if (editor.is_loading()) {
        constexpr const char* kDots[] = {"", ".", "..", "..."};
        message = editor.loading_label() + kDots[static_cast<int>(ImGui::GetTime() * 3) % 4];
        tip = "A file is being read in the background.";
    } else if (!editor.log.entries().empty() && editor.log.entries().back().level != LogLevel::info) {
        const LogEntry& entry = editor.log.entries().back();
        const bool is_error = entry.level == LogLevel::error;
        const std::string first_line = entry.text.substr(0, entry.text.find('\n'));
        message = fmt::format("{}  {}", is_error ? icon::kError : icon::kWarning, first_line.substr(0, 90));
        color = is_error ? theme::kError : theme::kWarning;
        tip = entry.text + "\nClick to open the log.";
    }

    const float spacing = ImGui::GetStyle().ItemSpacing.x;
    const float title_width = ImGui::CalcTextSize(title.c_str()).x + 2 * spacing;
    const float message_width = message.empty() ? 0 : ImGui::CalcTextSize(message.c_str()).x + 2 * spacing;
    const float start = ImGui::GetWindowWidth() - title_width - message_width;
    ImGui::SameLine(std::max(start, ImGui::GetCursorPosX() + spacing));
    if (!message.empty()) {
        ImGui::TextColored({color.x, color.y, color.z, color.w}, "%s", message.c_str());
        tooltip(tip);
        if (ImGui::IsItemClicked()) {
            const auto log = std::ranges::find(kPanels, std::string_view("Log"),
                                               [](const Panel& p) { return std::string_view(p.name); });
            editor.panels.closed[static_cast<std::size_t>(log - kPanels.begin())] = false;
            ImGui::SetWindowFocus("Log");
        }
        ImGui::SameLine();
    }
    ImGui::TextDisabled("%s", title.c_str());
    tooltip(editor.file().empty() ? "This scene has no file yet." : editor.file().string());
}

void run_shortcuts(Editor& editor) {
    const bool busy = ImGui::GetIO().WantTextInput || ImGui::IsAnyMouseDown() ||
                      ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    if (busy) return;
    for (const Command& command : commands()) {
        const auto pressed = [](int chord) { return chord != 0 && ImGui::IsKeyChordPressed(chord); };
        if (pressed(command.shortcut) || pressed(command.alternative)) run(command, editor);
    }
}

}  // namespace

void draw_menu_bar(Editor& editor) {
    run_shortcuts(editor);
    if (ImGui::BeginMainMenuBar()) {
        for (const char* menu : kMenus) {
            if (!ImGui::BeginMenu(menu)) continue;
            draw_menu(editor, menu);
            ImGui::EndMenu();
        }
        draw_status(editor);
        ImGui::EndMainMenuBar();
    }
    draw_dialogs(editor);
}

}  // namespace rayuela
