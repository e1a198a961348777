#pragma once

#include "ui/theme.h"

#include <imgui.h>

#include <string>

namespace rayuela {

ImVec4 to_imgui(const Vec4& color);

/// A table of names and numbers, `width` wide, closed by ImGui::EndTable where it returns true. `share`: room for numbers
/// over that for names.
bool begin_number_table(const char* id, float width, float share = 1.1f);
/// A line of it; `color` of the number, null: that of text.
void number_row(const char* name, const std::string& value, const char* tip, const Vec4* color = nullptr);

}  // namespace rayuela
