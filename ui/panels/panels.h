#pragma once

#include "ui/editor.h"

#include <array>

namespace rayuela {

void draw_scene_panel(Editor& editor);
void draw_inspector_panel(Editor& editor);
void draw_camera_panel(Editor& editor);
void draw_render_panel(Editor& editor);
void draw_statistics_panel(Editor& editor);
void draw_skips_panel(Editor& editor);
void draw_log_panel(Editor& editor);
void draw_health_panel(Editor& editor);

enum class DockArea : std::uint8_t { left, right_top, right_bottom, bottom };

/// A dockable panel, open unless Editor::panels.closed[its index in kPanels]. `draw` fills the window that the caller has
/// begun. The View menu, the default layout and the tests loop over kPanels.
struct Panel {
    const char* name;  ///< ImGui window name.
    const char* tip;
    DockArea area;
    void (*draw)(Editor&);
};

inline constexpr std::array kPanels = {
    Panel{"Scene", "All objects: add, hide, rename, duplicate, delete.", DockArea::left, draw_scene_panel},
    Panel{"Inspector", "The selected object: shape, transform and material.", DockArea::right_top,
          draw_inspector_panel},
    Panel{"Camera", "Where from and how the scene is seen.", DockArea::right_bottom, draw_camera_panel},
    Panel{"Render", "Structure, leaf size, bounces, limits.", DockArea::right_bottom, draw_render_panel},
    Panel{"Statistics", "What the renderer does, in numbers.", DockArea::bottom, draw_statistics_panel},
    Panel{"Skips", "What this scene skips, and why.", DockArea::bottom, draw_skips_panel},
    Panel{"Log", "What has happened.", DockArea::bottom, draw_log_panel},
    Panel{"Health", "How sound the numbers are: rejected samples, self-hits, energy; any sample step by step.",
          DockArea::bottom, draw_health_panel},
};

}  // namespace rayuela
