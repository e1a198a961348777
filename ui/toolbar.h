#pragma once

#include "ui/editor.h"

namespace rayuela {

/// The strip above the image: gizmo, zoom, tone map, exposure, pause. Fills the current line.
void draw_toolbar(Editor& editor);

/// The strip below the image: what the renderer is doing and, at its right end, the pixel under the mouse.
/// `pixel`: position in the film, negative where the mouse is elsewhere.
void draw_status_line(Editor& editor, const glm::ivec2& pixel);

}  // namespace rayuela
