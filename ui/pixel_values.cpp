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

ImVec2 to_imgui(const Vec2& v) {
    return {v.x, v.y};
}

ImU32 srgb(const Color& linear) {
    return ImGui::GetColorU32(ImVec4(linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z), 1));
}

}  // namespace

void draw_pixel_values(const Frame& frame, const Canvas& canvas, const ViewSettings& view) {
    const ImageView shown = canvas.view(view);
    if (shown.zoom < kPixelValueZoom || frame.image.pixels.empty() || frame.coarse) return;
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

void draw_false_color_scale(const Canvas& canvas, const ViewSettings& view) {
    if (view.tone_map != ToneMap::false_color) return;
    constexpr float kMiddleGray = 0.18f;
    constexpr int kLowest = -8, kHighest = 6;
    const float unit = ImGui::GetFontSize();
    const Vec2 size(0.8f * unit, 14 * unit);
    const Vec2 corner = canvas.corner + Vec2(unit, canvas.size.y - size.y - 1.2f * unit);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(to_imgui(corner - 0.5f * unit), to_imgui(corner + size + Vec2(5.2f * unit, 0.5f * unit)),
                       IM_COL32(10, 11, 12, 190), 0.35f * unit);
    constexpr int kSteps = 56;
    for (int i = 0; i < kSteps; ++i) {
        const float stops = kLowest + (kHighest - kLowest) * (static_cast<float>(i) + 0.5f) / kSteps;
        const Color color = tone_mapped(Color(kMiddleGray * std::exp2(stops)), 0, ToneMap::false_color);
        const float bottom = corner.y + size.y * (1 - static_cast<float>(i) / kSteps);
        list.AddRectFilled({corner.x, bottom - size.y / kSteps}, {corner.x + size.x, bottom}, srgb(color));
    }
    for (int stops = kLowest; stops <= kHighest; stops += 2) {
        const float y = corner.y + size.y * static_cast<float>(kHighest - stops) / (kHighest - kLowest);
        // What radiance has this colour at the exposure that is set.
        const float radiance = kMiddleGray * std::exp2(static_cast<float>(stops) - view.exposure);
        const std::string text = fmt::format("{:.3g}", radiance);
        list.AddText(mono_font(), 0.8f * unit, {corner.x + 1.4f * unit, y - 0.4f * unit},
                     ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
    }
}

}  // namespace rayuela
