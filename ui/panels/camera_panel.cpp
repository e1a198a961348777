#include "ui/camera_views.h"
#include "ui/icons.h"
#include "ui/object_actions.h"
#include "ui/panels/panels.h"
#include "ui/widgets.h"

#include <fmt/format.h>

namespace rayuela {
namespace {

struct FilmPreset {
    const char* name;
    int width, height;
};
constexpr FilmPreset kFilmPresets[] = {{"HD 720", 1280, 720},  {"Full HD", 1920, 1080},    {"4K", 3840, 2160},
                                       {"Square", 1024, 1024}, {"Portrait", 1080, 1920},   {"Photo 3:2", 1500, 1000},
                                       {"Cinema", 2048, 858},  {"Small preview", 640, 360}};

void draw_view_buttons(Editor& editor) {
    const Camera& camera = editor.scene().camera;
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - 5 * spacing) / 6;
    bool first = true;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {2, ImGui::GetStyle().FramePadding.y});
    for (const AxisView& view : axis_views()) {
        if (!first) ImGui::SameLine(0, spacing);
        first = false;
        if (ImGui::Button(view.name, {width, 0}))
            editor.edit(SetCamera{looking_along(camera, view)}, fmt::format("{} view", view.name));
        tooltip(fmt::format("Looks at the target from the {}.", view.name));
    }
    ImGui::PopStyleVar();
}

void draw_framing_buttons(Editor& editor) {
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - 2 * spacing) / 3;
    const bool selected = editor.selection.has_value();
    if (ImGui::Button("Frame all", {width, 0})) frame_bounds_of(editor, {});
    tooltip("Moves the camera so that everything is in view (Home).");
    ImGui::SameLine(0, spacing);
    ImGui::BeginDisabled(!selected);
    if (ImGui::Button("Frame selected", {width, 0})) frame_bounds_of(editor, editor.selection);
    tooltip("Moves the camera so that the selected object fills the view (F).");
    ImGui::SameLine(0, spacing);
    if (ImGui::Button("Focus on it", {width, 0}) && editor.selection) {
        const Bounds3 bounds = bounds_to_frame(editor.scene(), editor.selection);
        if (!bounds.empty())
            editor.edit(SetCamera{focused_on(editor.scene().camera, bounds.center())}, "Focus on selection");
    }
    ImGui::EndDisabled();
    tooltip("Makes the selected object's middle sharp. In the image, double-click the point that should be sharp.");
}

void draw_film(Editor& editor) {
    field_label("Match window", "The image takes the size of the viewport.");
    ImGui::Checkbox("##match window", &editor.view.match_window);
    tooltip("The image takes the size of the viewport. Off: it has the size given below, whatever the window's.");
    if (editor.view.match_window) {
        ImGui::SameLine();
        ImGui::TextDisabled("%d x %d now", editor.shown().film.width, editor.shown().film.height);
    }

    FilmSettings film = editor.scene().film;
    bool changed = false;
    field_label("Image size", "Pixels, when the scene is rendered to a file or does not match the window.");
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float combo = ImGui::GetFrameHeight();
    const float width = (ImGui::GetContentRegionAvail().x - combo - 2 * spacing) / 2;
    const auto side = [&](const char* id, int& value, const char* tip) {
        ImGui::SetNextItemWidth(width);
        changed |= ImGui::DragInt(id, &value, 1, 1, kMaxFilmSide, "%d px", ImGuiSliderFlags_AlwaysClamp);
        tooltip(tip);
        ImGui::SameLine(0, spacing);
    };
    side("##width", film.width, "Width in pixels.");
    side("##height", film.height, "Height in pixels.");
    if (ImGui::BeginCombo("##presets", "", ImGuiComboFlags_NoPreview)) {
        for (const FilmPreset& preset : kFilmPresets) {
            const bool selected = film.width == preset.width && film.height == preset.height;
            if (ImGui::Selectable(
                    fmt::format("{}  {} x {}###{}", preset.name, preset.width, preset.height, preset.name).c_str(),
                    selected)) {
                film.width = preset.width;
                film.height = preset.height;
                changed = true;
            }
            tooltip("Takes this size.");
        }
        ImGui::EndCombo();
    }
    tooltip("Sizes in common use.");
    if (changed) editor.edit(SetFilm{film}, "Change image size");
}

}  // namespace

void draw_camera_panel(Editor& editor) {
    Camera camera = editor.scene().camera;
    ImGui::PushID("camera");
    if (draw_fields(camera)) editor.edit(SetCamera{camera}, "Change camera");
    ImGui::PopID();
    ImGui::SeparatorText("Views");
    draw_view_buttons(editor);
    draw_framing_buttons(editor);
    ImGui::SeparatorText("Image");
    draw_film(editor);
}

}  // namespace rayuela
