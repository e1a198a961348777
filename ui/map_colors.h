#pragma once

#include "core/math/image.h"
#include "ui/camera_control.h"
#include "ui/view_settings.h"

#include <span>
#include <string>

namespace rayuela {

/// The colour of a number of a map, display-linear: the logarithm in false colours from blue to red, dark grey where there
/// is nothing to say, magenta for infinity.
Color map_color(ViewMap map, float value);
Image map_image(ViewMap map, std::span<const float> values, const glm::ivec2& size);
/// The number in words, for the status line.
std::string map_value_text(ViewMap map, float value);
/// What the colours mean, in the image's lower left corner; nothing for the image itself.
void draw_map_scale(const Canvas& canvas, ViewMap map);

}  // namespace rayuela
