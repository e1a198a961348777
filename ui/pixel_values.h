#pragma once

#include "core/render/frame.h"
#include "ui/camera_control.h"

#include <span>
#include <string>

namespace rayuela {

/// From this zoom on the values of pixels can be read in them.
inline constexpr float kPixelValueZoom = 40;

/// Writes the linear radiance into every visible pixel, where the zoom leaves room for it. Draws into the current window.
void draw_pixel_values(const Frame& frame, const Canvas& canvas, const ViewSettings& view);

/// False colours from blue (0) to red (1), display-linear; beyond them the colours of the ends.
Color scale_color(float at);
/// A number beside the scale of false colours, at its place in [0, 1].
struct ScaleMark {
    float at = 0;
    std::string text;
};
/// The scale at the lower left of the canvas; above it `color`, which stands for `beyond`, if that is not null.
void draw_color_scale(const Canvas& canvas, std::span<const ScaleMark> marks, const char* beyond = nullptr,
                      const Color& color = Color(0));

/// The scale of the false colours of the image, where it is shown in them.
void draw_false_color_scale(const Canvas& canvas, const ViewSettings& view);

}  // namespace rayuela
