#include "ui/icons.h"
#include "ui/panels/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <misc/cpp/imgui_stdlib.h>

#include <algorithm>
#include <ctime>

namespace rayuela {
namespace {

struct Level {
    const char* icon;
    const char* name;
    const Vec4* color;
};
constexpr Level kLevels[] = {{icon::kInfo, "Messages", &theme::kMuted},
                             {icon::kWarning, "Warnings", &theme::kWarning},
                             {icon::kError, "Errors", &theme::kError}};

const Level& level_of(const LogEntry& entry) {
    return kLevels[static_cast<std::size_t>(entry.level)];
}

ImVec4 to_imgui(const Vec4& color) {
    return {color.x, color.y, color.z, color.w};
}

std::string time_text(const LogEntry& entry) {
    const std::time_t time = std::chrono::system_clock::to_time_t(entry.time);
    return fmt::format("{:%H:%M:%S}", fmt::localtime(time));
}

bool is_shown(const LogEntry& entry, const PanelState& state) {
    return state.log_levels[static_cast<std::size_t>(entry.level)] &&
           (state.log_filter.empty() || entry.text.find(state.log_filter) != std::string::npos);
}

void copy_to_clipboard(const Log& log, const PanelState& state) {
    std::string text;
    for (const LogEntry& entry : log.entries()) {
        if (is_shown(entry, state))
            text += fmt::format("{} {}: {}\n", time_text(entry), level_of(entry).name, entry.text);
    }
    ImGui::SetClipboardText(text.c_str());
}

void draw_header(Editor& editor) {
    PanelState& state = editor.panels;
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    for (std::size_t i = 0; i < std::size(kLevels); ++i) {
        const auto count = std::ranges::count(editor.log.entries(), static_cast<LogLevel>(i), &LogEntry::level);
        ImGui::PushStyleColor(ImGuiCol_Text, state.log_levels[i] ? to_imgui(*kLevels[i].color)
                                                                 : ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        if (ImGui::Button(fmt::format("{} {}###{}", kLevels[i].icon, count, kLevels[i].name).c_str()))
            state.log_levels[i] = !state.log_levels[i];
        ImGui::PopStyleColor();
        tooltip(fmt::format("{}: click to {} them.", kLevels[i].name, state.log_levels[i] ? "hide" : "show"));
        ImGui::SameLine(0, spacing);
    }
    ImGui::SetNextItemWidth(-2 * (ImGui::GetFrameHeight() + spacing));
    ImGui::InputTextWithHint("##filter", fmt::format("{}  Filter", icon::kSearch).c_str(), &state.log_filter);
    tooltip("Shows only lines that contain this.");
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kCopy, "copy", "Copies the lines shown to the clipboard."))
        copy_to_clipboard(editor.log, state);
    ImGui::SameLine(0, spacing);
    if (icon_button(icon::kDelete, "clear", "Forgets all lines.")) editor.log.clear();
}

}  // namespace

void draw_log_panel(Editor& editor) {
    draw_header(editor);
    if (ImGui::BeginChild("lines")) {
        if (editor.log.entries().empty())
            hint("Nothing has happened yet. Files opened and saved, warnings and errors are told here.");
        for (const LogEntry& entry : editor.log.entries()) {
            if (!is_shown(entry, editor.panels)) continue;
            const Level& level = level_of(entry);
            ImGui::TextDisabled("%s", time_text(entry).c_str());
            ImGui::SameLine();
            ImGui::PushStyleColor(ImGuiCol_Text, entry.level == LogLevel::info ? ImGui::GetStyleColorVec4(ImGuiCol_Text)
                                                                               : to_imgui(*level.color));
            const std::string count = entry.count > 1 ? fmt::format("  ({} times)", entry.count) : "";
            ImGui::TextWrapped("%s  %s%s", level.icon, entry.text.c_str(), count.c_str());
            ImGui::PopStyleColor();
        }
        // Keeps the newest in view, unless somebody reads further up.
        if (editor.panels.log_seen != editor.log.entries().size()) ImGui::SetScrollHereY(1);
        editor.panels.log_seen = editor.log.entries().size();
    }
    ImGui::EndChild();
}

}  // namespace rayuela
