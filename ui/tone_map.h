#pragma once

#include "core/math/image.h"
#include "ui/view_settings.h"

namespace rayuela {

/// The colour that a display shows for a radiance, display-linear sRGB in [0, 1]: exposure, then the tone map, then
/// clipping. What is not finite shows as black. shaders/display.frag computes the same.
Color tone_mapped(const Color& radiance, float exposure, ToneMap tone_map);
/// The whole image, alpha 1.
Image tone_mapped(const Image& image, float exposure, ToneMap tone_map);

}  // namespace rayuela
