#include "ui/theme.h"

#include "ui/embedded.h"

#include <imgui.h>

#include <array>
#include <cmath>

namespace rayuela {

namespace {

/// False where the file is not embedded.
bool add_font(const char* file, const char* merged, float size_factor) {
    const auto bytes = embedded_font(file);
    if (bytes.empty()) return false;
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    // ImGui takes a pointer to data it may free; it does not with the flag above.
    const auto data = [](std::span<const unsigned char> font) { return const_cast<unsigned char*>(font.data()); };
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.AddFontFromMemoryTTF(data(bytes), static_cast<int>(bytes.size()), theme::kFontSize * size_factor, &config);
    if (const auto icons = embedded_font(merged); !icons.empty()) {
        config.MergeMode = true;
        config.GlyphMinAdvanceX = theme::kFontSize * 1.2f;
        config.GlyphOffset.y = 1;
        atlas.AddFontFromMemoryTTF(data(icons), static_cast<int>(icons.size()), theme::kFontSize * 0.82f, &config);
    }
    return true;
}

ImVec4 gray(float value, float alpha = 1) {
    // A trace of blue keeps large dark areas from looking brown beside the image.
    return {value * 0.95f, value, value * 1.08f, alpha};
}

ImVec4 accent(float alpha) {
    return {theme::kAccent.x, theme::kAccent.y, theme::kAccent.z, alpha};
}

void set_colors(ImGuiStyle& style) {
    ImGui::StyleColorsDark(&style);
    const auto set = [&](ImGuiCol index, const ImVec4& color) { style.Colors[index] = color; };
    set(ImGuiCol_Text, gray(0.87f));
    set(ImGuiCol_TextDisabled, gray(0.50f));
    set(ImGuiCol_WindowBg, gray(0.115f));
    set(ImGuiCol_ChildBg, gray(0, 0));
    set(ImGuiCol_PopupBg, gray(0.15f, 0.98f));
    set(ImGuiCol_MenuBarBg, gray(0.085f));
    set(ImGuiCol_Border, gray(0.22f));
    set(ImGuiCol_FrameBg, gray(0.18f));
    set(ImGuiCol_FrameBgHovered, gray(0.225f));
    set(ImGuiCol_FrameBgActive, gray(0.26f));
    set(ImGuiCol_TitleBg, gray(0.085f));
    set(ImGuiCol_TitleBgActive, gray(0.085f));
    set(ImGuiCol_TitleBgCollapsed, gray(0.085f));
    set(ImGuiCol_ScrollbarBg, gray(0, 0));
    set(ImGuiCol_ScrollbarGrab, gray(0.26f));
    set(ImGuiCol_ScrollbarGrabHovered, gray(0.33f));
    set(ImGuiCol_ScrollbarGrabActive, gray(0.40f));
    set(ImGuiCol_CheckMark, accent(1));
    set(ImGuiCol_SliderGrab, accent(0.85f));
    set(ImGuiCol_SliderGrabActive, accent(1));
    set(ImGuiCol_Button, gray(0.21f));
    set(ImGuiCol_ButtonHovered, gray(0.27f));
    set(ImGuiCol_ButtonActive, gray(0.32f));
    set(ImGuiCol_Header, accent(0.20f));
    set(ImGuiCol_HeaderHovered, accent(0.12f));
    set(ImGuiCol_HeaderActive, accent(0.28f));
    set(ImGuiCol_Separator, gray(0.20f));
    set(ImGuiCol_SeparatorHovered, accent(0.55f));
    set(ImGuiCol_SeparatorActive, accent(0.9f));
    set(ImGuiCol_ResizeGrip, gray(0, 0));
    set(ImGuiCol_ResizeGripHovered, accent(0.4f));
    set(ImGuiCol_ResizeGripActive, accent(0.7f));
    set(ImGuiCol_Tab, gray(0.085f));
    set(ImGuiCol_TabHovered, gray(0.19f));
    set(ImGuiCol_TabSelected, gray(0.115f));
    set(ImGuiCol_TabSelectedOverline, accent(1));
    set(ImGuiCol_TabDimmed, gray(0.085f));
    set(ImGuiCol_TabDimmedSelected, gray(0.115f));
    set(ImGuiCol_TabDimmedSelectedOverline, gray(0.30f));
    set(ImGuiCol_DockingPreview, accent(0.45f));
    set(ImGuiCol_DockingEmptyBg, gray(0.07f));
    set(ImGuiCol_PlotLines, accent(1));
    set(ImGuiCol_PlotHistogram, accent(0.9f));
    set(ImGuiCol_TableHeaderBg, gray(0.15f));
    set(ImGuiCol_TableBorderStrong, gray(0.22f));
    set(ImGuiCol_TableBorderLight, gray(0.17f));
    set(ImGuiCol_TableRowBgAlt, gray(1, 0.02f));
    set(ImGuiCol_TextSelectedBg, accent(0.35f));
    set(ImGuiCol_DragDropTarget, accent(0.9f));
    set(ImGuiCol_NavCursor, accent(0.8f));
    set(ImGuiCol_ModalWindowDimBg, {0, 0, 0, 0.45f});
}

void set_sizes(ImGuiStyle& style) {
    style.WindowPadding = {10, 8};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 6};
    style.ItemInnerSpacing = {6, 4};
    style.CellPadding = {6, 3};
    style.IndentSpacing = 16;
    style.ScrollbarSize = 12;
    style.GrabMinSize = 10;
    style.WindowRounding = 6;
    style.ChildRounding = 5;
    style.FrameRounding = 4;
    style.PopupRounding = 6;
    style.ScrollbarRounding = 6;
    style.GrabRounding = 4;
    style.TabRounding = 4;
    style.WindowBorderSize = 0;
    style.PopupBorderSize = 1;
    style.FrameBorderSize = 0;
    style.TabBarBorderSize = 0;
    style.TabBarOverlineSize = 2;
    style.DockingSeparatorSize = 2;
    style.SeparatorTextBorderSize = 1;
    style.SeparatorTextPadding = {0, 6};
    style.WindowMenuButtonPosition = ImGuiDir_None;
    style.ColorButtonPosition = ImGuiDir_Left;
    style.HoverDelayNormal = 0.5f;
}

}  // namespace

void load_fonts() {
    if (!add_font("Inter-Regular.otf", "FontAwesome6-Solid.otf", 1)) ImGui::GetIO().Fonts->AddFontDefault();
    add_font("JetBrainsMono-Regular.ttf", "FontAwesome6-Solid.otf", 0.93f);
}

ImFont* mono_font() {
    return ImGui::GetIO().Fonts->Fonts.back();
}

void apply_theme(float scale) {
    ImGuiStyle style;
    set_colors(style);
    set_sizes(style);
    style.ScaleAllSizes(scale);
    style.FontSizeBase = theme::kFontSize;
    style.FontScaleDpi = scale;
    ImGui::GetStyle() = style;
}

}  // namespace rayuela
