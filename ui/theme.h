#pragma once

#include "core/math/vec.h"

struct ImFont;

namespace rayuela {

/// Colours that mean something, sRGB. Everything else comes from ImGui's style, which `apply_theme` sets.
namespace theme {
inline constexpr Vec4 kAccent{0.98f, 0.66f, 0.29f, 1};  ///< What is selected or active.
inline constexpr Vec4 kMuted{0.55f, 0.58f, 0.62f, 1};   ///< Labels, hints.
inline constexpr Vec4 kGood{0.49f, 0.78f, 0.56f, 1};
inline constexpr Vec4 kWarning{0.95f, 0.76f, 0.36f, 1};
inline constexpr Vec4 kError{0.94f, 0.42f, 0.40f, 1};
inline constexpr float kFontSize = 15.5f;  ///< At scale 1, pixels.
}  // namespace theme

/// Adds the fonts to the current ImGui context; the first is the default. Without embedded fonts, ImGui's own.
void load_fonts();

/// The font whose figures have one width, for tables of numbers.
ImFont* mono_font();

/// Colours, sizes and spacing of the current ImGui context; `scale` is pixels a unit of the user interface.
void apply_theme(float scale);

}  // namespace rayuela
