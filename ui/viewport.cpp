#include "ui/viewport.h"

#include "ui/layout.h"
#include "ui/map_colors.h"
#include "ui/pixel_values.h"
#include "ui/theme.h"
#include "ui/toolbar.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

constexpr double kResizeDelay = 0.12;  ///< Seconds for which a size must hold before the film takes it.
constexpr float kOutlineWidth = 2;
constexpr int kSmallestFilm = 16;

/// A strip of the viewport with buttons or text, as high as a line of them.
template <typename Draw>
void strip(const char* id, float height, const Draw& draw) {
    const float unit = ImGui::GetFontSize();
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.45f * unit, 0.25f * unit));
    ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetStyleColorVec4(ImGuiCol_WindowBg));
    ImGui::PushStyleVar(ImGuiStyleVar_ChildRounding, 0);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;
    if (ImGui::BeginChild(id, {0, height}, ImGuiChildFlags_AlwaysUseWindowPadding, flags)) draw();
    ImGui::EndChild();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
}

void draw_centered(const Canvas& canvas, float line, const std::string& text, ImGuiCol color) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const Vec2 position = canvas.corner + 0.5f * (canvas.size - Vec2(size.x, size.y)) + Vec2(0, line * 1.6f * size.y);
    ImGui::GetWindowDrawList()->AddText({position.x, position.y}, ImGui::GetColorU32(color), text.c_str());
}

/// A frame around the pixel whose sample is replayed.
void mark_pixel(const Canvas& canvas, const Editor& editor) {
    if (!editor.health.replayed()) return;
    const ImageView view = canvas.view(editor.view);
    const Vec2 pixel(editor.health.replayed_pixel);
    const float margin = 0.25f * ImGui::GetFontSize();
    const Vec2 low = canvas.corner + view.to_viewport(pixel) / canvas.density - margin;
    const Vec2 high = canvas.corner + view.to_viewport(pixel + 1.0f) / canvas.density + margin;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRect({low.x - 1, low.y - 1}, {high.x + 1, high.y + 1}, IM_COL32(0, 0, 0, 200), 0, 3.0f);
    list.AddRect({low.x, low.y}, {high.x, high.y}, ImGui::GetColorU32(ImVec4(1, 1, 1, 1)));
}

}  // namespace

void Viewport::draw(Editor& editor) {
    // It is the centre that everything else is docked around: no tab, nothing on top of it.
    ImGuiWindowClass window_class;
    window_class.DockNodeFlagsOverrideSet = static_cast<int>(ImGuiDockNodeFlags_NoTabBar) |
                                            static_cast<int>(ImGuiDockNodeFlags_NoUndocking) |
                                            static_cast<int>(ImGuiDockNodeFlags_NoDockingOverMe);
    ImGui::SetNextWindowClass(&window_class);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, 0));
    const bool visible =
        ImGui::Begin(kViewportName, nullptr,
                     ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoBackground |
                         ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
    ImGui::PopStyleVar(2);
    if (visible) {
        const float height = std::round(ImGui::GetFrameHeight() + 0.5f * ImGui::GetFontSize());
        strip("toolbar", height, [&] { draw_toolbar(editor); });
        ImGui::SetCursorPosY(ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y);
        const ImVec2 room = ImGui::GetContentRegionAvail();
        draw_image(editor, {std::floor(room.x), std::floor(room.y - height)});
        ImGui::SetCursorPosY(ImGui::GetWindowHeight() - height);
        const bool focused = ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows) || ImGui::IsWindowHovered();
        const bool busy = ImGui::GetIO().WantTextInput || ImGui::IsAnyMouseDown();
        if (focused && !busy && ImGui::IsKeyPressed(ImGuiKey_Escape, false)) editor.selection.reset();
        strip("status", height, [&] { draw_status_line(editor, hovered_pixel_); });
    }
    ImGui::End();
}

void Viewport::draw_image(Editor& editor, const Vec2& size) {
    if (size.x < 1 || size.y < 1) return;
    const std::shared_ptr<const Frame>& frame = editor.frame();
    const FilmSettings film = frame && frame->scene ? frame->scene->film : editor.shown().film;
    const ImVec2 cursor = ImGui::GetCursorScreenPos();
    canvas_.corner = {std::floor(cursor.x), std::floor(cursor.y)};
    canvas_.size = size;
    canvas_.image_size = {film.width, film.height};
    canvas_.density = ImGui::GetIO().DisplayFramebufferScale.x;
    fit_film(editor);

    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const ImageView before = canvas_.view(editor.view);
    const Vec2 corner = canvas_.corner + before.origin / canvas_.density;
    const Vec2 image_size = canvas_.image_size * before.zoom / canvas_.density;

    // The image goes below the gizmo, but its item after it.
    ImDrawList& list = *ImGui::GetWindowDrawList();
    DisplayRequest request;
    request.size = glm::ivec2(size * canvas_.density);
    request.origin = before.origin;
    request.zoom = before.zoom;
    const std::shared_ptr<const Frame> map = editor.health.picture();
    if (!map) {
        request.exposure = editor.view.exposure;
        request.tone_map = editor.view.tone_map;
    }
    if (editor.view.show_outline && editor.selection) {
        request.outline_width = kOutlineWidth * ImGui::GetFontSize() / theme::kFontSize * canvas_.density;
        request.outlined = with_children(editor.scene(), *editor.selection);
    }
    const Vec2 end = canvas_.corner + size;
    if (const Display::Picture picture = display_.draw(map ? map : frame, request); picture.texture) {
        list.AddImage(static_cast<ImTextureID>(picture.texture), {canvas_.corner.x, canvas_.corner.y}, {end.x, end.y},
                      {0, 1}, {picture.lower_right.x, picture.lower_right.y});
    }
    const bool on_gizmo = gizmo_.draw(editor, corner, image_size);

    ImGui::SetCursorScreenPos({canvas_.corner.x, canvas_.corner.y});
    if (on_gizmo) {
        ImGui::Dummy({size.x, size.y});
    } else {
        ImGui::InvisibleButton(
            "image", {size.x, size.y},
            ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle | ImGuiButtonFlags_MouseButtonRight);
        control_.update(editor, canvas_);
    }
    const bool hovered = ImGui::IsItemHovered();
    hovered_pixel_ =
        hovered ? glm::ivec2(glm::floor(canvas_.to_image(editor.view, {mouse.x, mouse.y}))) : glm::ivec2(-1);
    draw_overlays(editor);
}

void Viewport::draw_overlays(Editor& editor) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Vec2 end = canvas_.corner + canvas_.size;
    list.PushClipRect({canvas_.corner.x, canvas_.corner.y}, {end.x, end.y}, true);
    if (editor.frame()) draw_pixel_values(*editor.frame(), canvas_, editor.view);
    draw_false_color_scale(canvas_, editor.view);
    draw_map_scale(canvas_, editor.view.map);
    if (editor.view.map != ViewMap::image && !editor.health.picture())
        draw_centered(canvas_, 0, "The map is being worked out", ImGuiCol_Text);
    mark_pixel(canvas_, editor);
    if (editor.is_loading() && editor.scene().objects.empty()) {
        draw_centered(canvas_, 0, fmt::format("Loading {}", editor.loading_label()), ImGuiCol_Text);
    } else if (editor.scene().objects.empty()) {
        draw_centered(canvas_, -0.5f, "This scene has no objects", ImGuiCol_Text);
        draw_centered(canvas_, 0.5f, "Add some with the Add menu, or drop a file here", ImGuiCol_TextDisabled);
    }
    list.PopClipRect();
}

void Viewport::fit_film(Editor& editor) {
    resizing_ = false;
    if (!editor.view.match_window) return;
    const glm::ivec2 room = glm::clamp(glm::ivec2(canvas_.size * canvas_.density), kSmallestFilm, kMaxFilmSide);
    const FilmSettings& film = editor.shown().film;
    if (room == glm::ivec2(film.width, film.height)) {
        wanted_film_ = room;
        return;
    }
    const double now = ImGui::GetTime();
    if (room != wanted_film_) {
        // The first size is no drag: nothing has been rendered yet.
        wanted_since_ = wanted_film_ == glm::ivec2(0) ? now - kResizeDelay : now;
        wanted_film_ = room;
    }
    resizing_ = now - wanted_since_ < kResizeDelay;
    if (!resizing_) editor.resize_film(room.x, room.y);
}

}  // namespace rayuela
