#pragma once

#include "core/render/frame.h"
#include "ui/camera_control.h"

namespace rayuela {

/// From this zoom on the values of pixels can be read in them.
inline constexpr float kPixelValueZoom = 40;

/// Writes the linear radiance into every visible pixel, where the zoom leaves room for it. Draws into the current window.
void draw_pixel_values(const Frame& frame, const Canvas& canvas, const ViewSettings& view);

/// The scale of the false colours, at the lower left of the canvas.
void draw_false_color_scale(const Canvas& canvas, const ViewSettings& view);

}  // namespace rayuela
