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
    {"State", "Skipped: left out. Needed: done. Absent: nothing asks for it."},
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

void draw_skip(const Skip& skip, const RenderStatistics& statistics) {
    const ImVec4 muted(theme::kMuted.x, theme::kMuted.y, theme::kMuted.z, theme::kMuted.w);
    const ImVec4 color = skip.state == SkipState::skipped ? ImGui::GetStyleColorVec4(ImGuiCol_Text) : muted;
    ImGui::TableNextRow();
    cell(std::string(skip.name), color, skip.why);
    cell(std::string(name_of(skip.state)), color, skip.why);
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
    constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("skips", static_cast<int>(std::size(kColumns)), kFlags)) return;
    draw_header();
    for (const Skip& skip : skips_of(*editor.frame())) draw_skip(skip, editor.frame()->statistics);
    ImGui::EndTable();
}

}  // namespace rayuela
