#include "ui/panels/number_table.h"

#include "ui/widgets.h"

#include <algorithm>

namespace rayuela {

ImVec4 to_imgui(const Vec4& color) {
    return {color.x, color.y, color.z, color.w};
}

void number_row(const char* name, const std::string& value, const char* tip, const Vec4* color) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", name);
    tooltip(tip);
    ImGui::TableNextColumn();
    const ImVec4 text = color ? to_imgui(*color) : ImGui::GetStyleColorVec4(ImGuiCol_Text);
    ImGui::PushFont(mono_font(), 0);
    const float width = ImGui::CalcTextSize(value.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(0.0f, ImGui::GetContentRegionAvail().x - width));
    ImGui::TextColored(text, "%s", value.c_str());
    ImGui::PopFont();
    tooltip(tip);
}

bool begin_number_table(const char* id, float width, float share) {
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp, {width, 0})) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, share);
    return true;
}

}  // namespace rayuela
