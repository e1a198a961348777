#include "ui/map_colors.h"

#include "ui/pixel_values.h"
#include "ui/tone_map.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

constexpr Color kNothing(0.022f), kDiffers(0.9f, 0.0f, 0.55f);

/// Decades of the scale: from 10^low to 10^high.
struct Decades {
    int low, high;
};

/// Else it is a count.
bool is_ratio(ViewMap map) {
    return map == ViewMap::position_error || map == ViewMap::retrace;
}

Decades decades(ViewMap map) {
    if (map == ViewMap::samples) return {0, 4};
    // One rejected sample must stand out from none.
    return map == ViewMap::rejected ? Decades{-1, 4} : Decades{-9, -3};
}

/// What stands for a map's infinity; null where it has none.
const char* infinity_text(ViewMap map) {
    return map == ViewMap::retrace ? "differs" : nullptr;
}

}  // namespace

Color map_color(ViewMap map, float value) {
    if (std::isnan(value) || (!is_ratio(map) && value == 0)) return kNothing;
    if (std::isinf(value)) return kDiffers;
    const auto [low, high] = decades(map);
    return scale_color((std::log10(value) - static_cast<float>(low)) / static_cast<float>(high - low));
}

Image map_image(ViewMap map, std::span<const float> values, const glm::ivec2& size) {
    Image image{size.x, size.y, {}, {}};
    image.pixels.reserve(values.size());
    for (const float value : values) image.pixels.emplace_back(map_color(map, value), 1);
    return image;
}

std::string map_value_text(ViewMap map, float value) {
    if (map == ViewMap::samples) return fmt::format("{:.0f} samples", value);
    if (map == ViewMap::rejected) return fmt::format("{:.0f} rejected", value);
    if (std::isnan(value)) return "nothing met";
    if (std::isinf(value)) return "float and double differ";
    return fmt::format("{} {:.2e}", map == ViewMap::retrace ? "difference" : "error", value);
}

void draw_map_scale(const Canvas& canvas, ViewMap map) {
    if (map == ViewMap::image) return;
    const auto [low, high] = decades(map);
    std::vector<ScaleMark> marks;
    for (int decade = is_ratio(map) ? low : 0; decade <= high; ++decade) {
        const float at = static_cast<float>(decade - low) / static_cast<float>(high - low);
        marks.push_back({at, fmt::format("{:g}", std::pow(10.0, decade))});
    }
    draw_color_scale(canvas, marks, infinity_text(map), kDiffers);
}

}  // namespace rayuela
