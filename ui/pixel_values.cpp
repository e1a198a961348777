#include "ui/pixel_values.h"

#include "core/math/srgb.h"
#include "ui/theme.h"
#include "ui/tone_map.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// What false colours span.
constexpr float kMiddleGray = 0.18f;
constexpr int kLowestStops = -8, kHighestStops = 6;

ImVec2 to_imgui(const Vec2& v) {
    return {v.x, v.y};
}

ImU32 srgb(const Color& linear) {
    return ImGui::GetColorU32(ImVec4(linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z), 1));
}

}  // namespace

void draw_pixel_values(const Frame& frame, const Canvas& canvas, const ViewSettings& view) {
    const ImageView shown = canvas.view(view);
    if (shown.zoom < kPixelValueZoom || frame.image.pixels.empty() || frame.coarse || view.map != ViewMap::image)
        return;
    const glm::ivec2 last(frame.image.width - 1, frame.image.height - 1);
    const glm::ivec2 from = glm::clamp(glm::ivec2(glm::floor(shown.to_image(Vec2(0)))), glm::ivec2(0), last);
    const glm::ivec2 to =
        glm::clamp(glm::ivec2(glm::floor(shown.to_image(canvas.size * canvas.density))), glm::ivec2(0), last);

    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float side = shown.zoom / canvas.density;
    const float font_size = std::min(side / 3.6f, ImGui::GetFontSize());
    for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
            const Color value(frame.image.at(x, y));
            const bool bright = luminance(tone_mapped(value, view.exposure, view.tone_map)) > 0.18f;
            const ImU32 ink = bright ? IM_COL32(0, 0, 0, 220) : IM_COL32(255, 255, 255, 220);
            const Vec2 corner = canvas.corner + shown.to_viewport(Vec2(x, y)) / canvas.density;
            for (int channel = 0; channel < 3; ++channel) {
                const std::string text = fmt::format("{:.3g}", value[channel]);
                const float line = corner.y + 0.12f * side + static_cast<float>(channel) * 0.27f * side;
                list.AddText(mono_font(), font_size, {corner.x + 0.08f * side, line}, ink, text.c_str());
            }
        }
    }
}

Color scale_color(float at) {
    const float stops = kLowestStops + (kHighestStops - kLowestStops) * std::clamp(at, 0.0f, 1.0f);
    return tone_mapped(Color(kMiddleGray * std::exp2(stops)), 0, ToneMap::false_color);
}

void draw_color_scale(const Canvas& canvas, std::span<const ScaleMark> marks, const char* beyond, const Color& color) {
    const float unit = ImGui::GetFontSize(), above = beyond ? 1.6f * unit : 0;
    const Vec2 size(0.8f * unit, 14 * unit);
    const Vec2 corner = canvas.corner + Vec2(unit, canvas.size.y - size.y - 1.2f * unit);
    const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
    const auto write = [&](float y, const char* text) {
        ImGui::GetWindowDrawList()->AddText(mono_font(), 0.8f * unit, {corner.x + 1.4f * unit, y}, ink, text);
    };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(to_imgui(corner - Vec2(0.5f * unit, 0.5f * unit + above)),
                       to_imgui(corner + size + Vec2(5.2f * unit, 0.5f * unit)), IM_COL32(10, 11, 12, 190),
                       0.35f * unit);
    constexpr int kSteps = 56;
    for (int i = 0; i < kSteps; ++i) {
        const float bottom = corner.y + size.y * (1 - static_cast<float>(i) / kSteps);
        list.AddRectFilled({corner.x, bottom - size.y / kSteps}, {corner.x + size.x, bottom},
                           srgb(scale_color((static_cast<float>(i) + 0.5f) / kSteps)));
    }
    for (const ScaleMark& mark : marks) write(corner.y + size.y * (1 - mark.at) - 0.4f * unit, mark.text.c_str());
    if (!beyond) return;
    list.AddRectFilled({corner.x, corner.y - above}, {corner.x + size.x, corner.y - above + size.x}, srgb(color));
    write(corner.y - above, beyond);
}

void draw_false_color_scale(const Canvas& canvas, const ViewSettings& view) {
    if (view.tone_map != ToneMap::false_color || view.map != ViewMap::image) return;
    std::vector<ScaleMark> marks;
    for (int stops = kLowestStops; stops <= kHighestStops; stops += 2) {
        // What radiance has this colour at the exposure that is set.
        const float radiance = kMiddleGray * std::exp2(static_cast<float>(stops) - view.exposure);
        const float at = static_cast<float>(stops - kLowestStops) / (kHighestStops - kLowestStops);
        marks.push_back({at, fmt::format("{:.3g}", radiance)});
    }
    draw_color_scale(canvas, marks);
}

}  // namespace rayuela
