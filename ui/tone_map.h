#pragma once

#include "core/math/vec.h"
#include "ui/view_settings.h"

namespace rayuela {

/// What shaders/display.frag does to a pixel: exposure and tone curve from linear radiance to linear display light in
/// [0, 1]. The sRGB curve is not yet applied.
Color tone_map(const Color& radiance, const ViewSettings& view);

/// Stops from black to white of the false-colour scale, around luminance 1 after exposure.
inline constexpr float kFalseColorStops = 6;

/// Colour of t in [0, 1] on the false-colour scale (Turbo, Mikhailov 2019), sRGB encoded.
Color false_color(float t);

}  // namespace rayuela
