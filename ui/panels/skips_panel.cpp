#include "core/render/skips.h"
#include "ui/number_text.h"
#include "ui/panels/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"

#include <imgui.h>

#include <iterator>

namespace rayuela {
namespace {

struct Column {
    const char* name;
    const char* tip;
};
constexpr Column kColumns[] = {
    {"What this scene skips", "Work and memory that the renderer leaves out where a scene does not need it."},
    {"State", "Skipped: left out. Put back: done though not needed. Needed: done. Absent: nothing asks for it."},
    {"Left out", "How much, where that is known."},
    {"Done", "Counted since the image last started anew: none where it is skipped."},
    {"Why", "Why this scene can do without, or what needs it."},
};

void draw_header() {
    ImGui::TableSetupScrollFreeze(0, 1);
    for (const Column& column : kColumns) {
        const bool last = &column == std::end(kColumns) - 1;
        ImGui::TableSetupColumn(column.name, last ? ImGuiTableColumnFlags_WidthStretch : ImGuiTableColumnFlags_None);
    }
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    for (const Column& column : kColumns) {
        ImGui::TableNextColumn();
        ImGui::TableHeader(column.name);
        tooltip(column.tip);
    }
}

void cell(const std::string& text, const ImVec4& color, const std::string& tip) {
    ImGui::TableNextColumn();
    ImGui::TextColored(color, "%s", text.c_str());
    tooltip(tip);
}

/// A box to put the work back with, where that can be done.
void draw_state(const Skip& skip, const ImVec4& color, Shortcuts& shortcuts) {
    const std::string state(name_of(skip.state));
    if (!skip.shortcut || (skip.state != SkipState::skipped && skip.state != SkipState::put_back)) {
        cell(state, color, skip.why);
        return;
    }
    ImGui::TableNextColumn();
    ImGui::PushID(skip.shortcut->key.data());
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));  // as high as a line of text
    ImGui::Checkbox(state.c_str(), &(shortcuts.*skip.shortcut->member));
    ImGui::PopStyleVar();
    ImGui::PopID();
    tooltip(skip.state == SkipState::skipped
                ? "Clear to put it back: the image will be the same, and take as long as without this shortcut."
                : "Tick to leave it out again.");
}

/// What the boxes are for, and how fast the render is with them as they are.
void draw_speed(Editor& editor, const RenderStatistics& statistics) {
    ImGui::Text("%s paths a second.", grouped_text(static_cast<std::uint64_t>(statistics.samples_per_second)).c_str());
    tooltip("Camera paths, since the image last started anew.");
    ImGui::SameLine();
    if (editor.shortcuts == Shortcuts{}) {
        ImGui::TextDisabled("Clear a box to put work back: same image, other speed.");
    } else {
        if (ImGui::SmallButton("Skip all again")) editor.shortcuts = {};
        tooltip("Leave out everything that the scene does not need.");
    }
}

void draw_skip(const Skip& skip, const RenderStatistics& statistics, Shortcuts& shortcuts) {
    const ImVec4 muted(theme::kMuted.x, theme::kMuted.y, theme::kMuted.z, theme::kMuted.w);
    const ImVec4 color = skip.state == SkipState::skipped ? ImGui::GetStyleColorVec4(ImGuiCol_Text) : muted;
    ImGui::TableNextRow();
    cell(std::string(skip.name), color, skip.why);
    draw_state(skip, color, shortcuts);
    cell(skip.saved > 0 ? amount_text(skip.saved, skip.unit) : "", color, skip.why);
    cell(skip.counter ? amount_text(skip.counter(statistics), skip.counted) : "", color, skip.why);
    cell(skip.why, muted, skip.why);
}

}  // namespace

void draw_skips_panel(Editor& editor) {
    if (!editor.frame()) {
        hint("What the scene does without appears here with the first image.");
        return;
    }
    const RenderStatistics& statistics = editor.frame()->statistics;
    draw_speed(editor, statistics);
    constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("skips", static_cast<int>(std::size(kColumns)), kFlags)) return;
    draw_header();
    for (const Skip& skip : skips_of(*editor.frame())) draw_skip(skip, statistics, editor.shortcuts);
    ImGui::EndTable();
}

}  // namespace rayuela
