#include "ui/toolbar.h"

#include "ui/camera_views.h"
#include "ui/icons.h"
#include "ui/map_colors.h"
#include "ui/number_text.h"
#include "ui/theme.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

ImVec4 color(const Vec4& c) {
    return {c.x, c.y, c.z, c.w};
}

void tooltip(const char* text) {
    ImGui::SetItemTooltip("%s", text);
}

/// A button of the size of an icon; pressed in the accent colour while `active`.
bool icon_button(const char* icon, const char* id, const char* tip, bool active = false) {
    const float side = ImGui::GetFrameHeight();
    ImGui::PushStyleColor(ImGuiCol_Button, active ? ImGui::GetStyleColorVec4(ImGuiCol_Header) : ImVec4(0, 0, 0, 0));
    if (active) ImGui::PushStyleColor(ImGuiCol_Text, color(theme::kAccent));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, ImGui::GetStyle().FramePadding.y));
    const bool pressed = ImGui::Button(fmt::format("{}###{}", icon, id).c_str(), {1.15f * side, side});
    ImGui::PopStyleVar();
    ImGui::PopStyleColor(active ? 2 : 1);
    tooltip(tip);
    ImGui::SameLine(0, 1);
    return pressed;
}

void separator() {
    const float height = ImGui::GetFrameHeight(), inset = 0.22f * height;
    ImGui::SameLine(0, 0.35f * height);
    const ImVec2 top = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddLine({top.x, top.y + inset}, {top.x, top.y + height - inset},
                                        ImGui::GetColorU32(ImGuiCol_Separator));
    ImGui::Dummy({1, height});
    ImGui::SameLine(0, 0.35f * height);
}

void draw_gizmo_modes(ViewSettings& view) {
    struct Mode {
        GizmoMode mode;
        const char *icon, *id, *tip;
    };
    constexpr Mode kModes[] = {
        {GizmoMode::none, icon::kPointer, "select",
         "Select: click an object, click again for its group; drag to turn around"},
        {GizmoMode::translate, icon::kMove, "move", "Move the selected object (G); hold Ctrl for round steps"},
        {GizmoMode::rotate, icon::kRotate, "rotate",
         "Rotate the selected object (R); hold Ctrl for steps of 15 degrees"},
        {GizmoMode::scale, icon::kScale, "scale", "Scale the selected object (S); hold Ctrl for round steps"},
    };
    for (const Mode& mode : kModes) {
        if (icon_button(mode.icon, mode.id, mode.tip, view.gizmo == mode.mode)) view.gizmo = mode.mode;
    }
}

void draw_zoom(Editor& editor) {
    ViewSettings& view = editor.view;
    if (icon_button(icon::kFit, "fit", "Fit the image to the viewport", view.fit)) view.fit = true;
    const bool actual = !view.fit && view.zoom == 1;
    if (icon_button("1:1", "actual", "One image pixel a screen pixel; Ctrl + wheel zooms further", actual)) {
        view.fit = false;
        view.zoom = 1;
        view.pan_x = view.pan_y = 0;
    }
    if (icon_button(icon::kOutline, "outline", "Outline the selected object", view.show_outline)) {
        view.show_outline = !view.show_outline;
    }
}

/// Tone maps, and below them what can be shown in place of the image.
void draw_view_choice(ViewSettings& view) {
    const bool shows_map = view.map != ViewMap::image;
    const char* const shown = shows_map ? kViewMaps[static_cast<std::size_t>(view.map)].name
                                        : kToneMapNames[static_cast<std::size_t>(view.tone_map)];
    if (!ImGui::BeginCombo("##tone_map", shown, ImGuiComboFlags_HeightLarge)) return;
    for (std::size_t i = 0; i < std::size(kToneMapNames); ++i) {
        const auto tone_map = static_cast<ToneMap>(i);
        if (!ImGui::Selectable(kToneMapNames[i], !shows_map && view.tone_map == tone_map)) continue;
        view.tone_map = tone_map;
        view.map = ViewMap::image;
    }
    ImGui::Separator();
    for (std::size_t i = 1; i < std::size(kViewMaps); ++i) {
        const auto map = static_cast<ViewMap>(i);
        if (ImGui::Selectable(kViewMaps[i].name, view.map == map)) view.map = map;
        tooltip(kViewMaps[i].tip);
    }
    ImGui::EndCombo();
}

void draw_tone(ViewSettings& view) {
    const float unit = ImGui::GetFontSize();
    ImGui::SetNextItemWidth(8 * unit);
    draw_view_choice(view);
    tooltip("How radiance becomes display colour, or which numbers are shown instead. Never restarts the image.");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(6.2f * unit);
    const std::string format = fmt::format("{}  %+.2f EV", icon::kSun);
    ImGui::DragFloat("##exposure", &view.exposure, 0.02f, -20, 20, format.c_str());
    tooltip("Exposure in stops: drag, double-click to type. Never restarts the image.");
    if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Right)) view.exposure = 0;
    ImGui::SameLine();
}

void draw_render_buttons(Editor& editor) {
    const float side = ImGui::GetFrameHeight();
    const float right = ImGui::GetContentRegionMax().x - 2.3f * side - 1;
    ImGui::SameLine(std::max(right, ImGui::GetCursorPosX()));
    const bool paused = editor.paused;
    if (icon_button(paused ? icon::kPlay : icon::kPause, "pause", paused ? "Resume rendering" : "Pause rendering",
                    paused)) {
        editor.paused = !paused;
    }
    if (icon_button(icon::kRestart, "restart", "Throw the samples away and start anew")) editor.session().restart();
}

/// The word for the phase, and its colour.
std::pair<std::string, Vec4> phase_text(const RenderStatistics& statistics, const SessionStatus& status, bool coarse) {
    switch (status.phase) {
        case SessionPhase::building:
            return {"Building", theme::kWarning};
        case SessionPhase::paused:
            return {"Paused", theme::kWarning};
        case SessionPhase::finished:
            return {"Finished", theme::kGood};
        case SessionPhase::rendering:
            return {coarse || statistics.spp == 0 ? "Preview" : "Rendering", theme::kAccent};
        case SessionPhase::idle:
            break;
    }
    return {"Idle", theme::kMuted};
}

void draw_progress(double fraction) {
    const float height = 0.35f * ImGui::GetFontSize(), width = 8 * ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float top = corner.y + 0.5f * (ImGui::GetFrameHeight() - height);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float done = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
    list.AddRectFilled({corner.x, top}, {corner.x + width, top + height}, ImGui::GetColorU32(ImGuiCol_FrameBg),
                       height / 2);
    list.AddRectFilled({corner.x, top}, {corner.x + width * done, top + height},
                       ImGui::GetColorU32(ImGuiCol_SliderGrab), height / 2);
    ImGui::Dummy({width, ImGui::GetFrameHeight()});
    ImGui::SameLine();
}

std::string pixel_text(const Editor& editor, const Frame& frame, const glm::ivec2& pixel) {
    if (const auto value = editor.health.value(pixel))
        return fmt::format("{:4d}, {:4d}   {}", pixel.x, pixel.y, map_value_text(editor.view.map, *value));
    const FilmSettings& film = frame.scene->film;
    const int x = pixel.x * frame.image.width / film.width, y = pixel.y * frame.image.height / film.height;
    const Vec4& value = frame.image.at(x, y);
    return fmt::format("{:4d}, {:4d}   R {:.4f}  G {:.4f}  B {:.4f}", pixel.x, pixel.y, value.x, value.y, value.z);
}

void draw_pixel(const Editor& editor, const Frame& frame, const glm::ivec2& pixel) {
    const std::string text = pixel_text(editor, frame, pixel);
    ImGui::PushFont(mono_font(), 0);
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    const float start = ImGui::GetContentRegionMax().x - width;
    if (start > ImGui::GetCursorPosX()) {
        ImGui::SameLine(start);
        ImGui::TextColored(color(theme::kMuted), "%s", text.c_str());
        tooltip("The pixel under the mouse: column, row and its linear radiance, or the number that the map shows");
    }
    ImGui::PopFont();
}

}  // namespace

void draw_toolbar(Editor& editor) {
    draw_gizmo_modes(editor.view);
    separator();
    draw_zoom(editor);
    separator();
    draw_tone(editor.view);
    draw_render_buttons(editor);
}

void draw_status_line(Editor& editor, const glm::ivec2& pixel) {
    const std::shared_ptr<const Frame>& frame = editor.frame();
    const SessionStatus status = editor.session().status();
    const RenderStatistics statistics = frame ? frame->statistics : RenderStatistics{};
    const auto [phase, phase_color] = phase_text(statistics, status, frame && frame->coarse);

    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(color(phase_color), "%s", phase.c_str());
    // A column of its own, so that the numbers keep their place when the word changes.
    ImGui::SameLine(6 * ImGui::GetFontSize());
    if (editor.is_loading()) {
        ImGui::Text("Loading %s", editor.loading_label().c_str());
        ImGui::SameLine(0, ImGui::GetFontSize());
    }
    if (status.phase == SessionPhase::building) draw_progress(status.build_progress);
    if (!frame || !frame->scene) return ImGui::NewLine();

    const FilmSettings& film = frame->scene->film;
    std::string text = fmt::format(
        "{} spp     {} x {}     {}     {} samples/s",
        statistics.adaptive ? fmt::format("{:.0f}", statistics.spread.mean) : std::to_string(statistics.spp),
        film.width, film.height, duration_text(statistics.render_seconds), count_text(statistics.samples_per_second));
    if (statistics.estimated_error > 0) text += fmt::format("     error {:.2g}", statistics.estimated_error);
    if (!editor.view.fit) text += fmt::format("     zoom {:.0f} %", 100 * editor.view.zoom);
    ImGui::TextUnformatted(text.c_str());
    tooltip("Samples a pixel, size of the image, rendering time, speed and estimated relative mean squared error");
    ImGui::SameLine(0, ImGui::GetFontSize());
    const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < film.width && pixel.y < film.height;
    if (inside && !frame->image.pixels.empty()) draw_pixel(editor, *frame, pixel);
    ImGui::NewLine();
}

}  // namespace rayuela
