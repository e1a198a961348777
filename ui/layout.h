#pragma once

namespace rayuela {

/// The name of the window that shows the image.
inline constexpr const char* kViewportName = "Viewport";

/// The dockspace under the menu bar, which fills the window. Where no layout is remembered, or `reset`, it puts the
/// viewport and every panel of kPanels in their first places.
void draw_dockspace(bool reset);

}  // namespace rayuela
