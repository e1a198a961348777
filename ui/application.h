#pragma once

#include "ui/display.h"
#include "ui/editor.h"
#include "ui/gl_context.h"

namespace rayuela {

/// The program's user interface on any GlContext: menu bar, dockspace, panels, viewport.
class Application {
public:
    Application(std::unique_ptr<GlContext> context, Preferences preferences, int threads = 0);
    ~Application();
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;

    Editor& editor();
    /// The window's loop: until closed. Sleeps while nothing changes.
    void run();
    /// Draws one frame of the user interface (events have been put into ImGui's queue before). Used by `run`, by the
    /// screenshot and by the tests.
    void draw_frame();
    /// What dropping a file on the window does: opens it, or with Shift held adds it to the scene.
    void drop(const std::filesystem::path& file);
    /// Draws until the scene is loaded and its image has at least `spp` samples, then returns what the window shows.
    Image screenshot(int spp);
    const Display::Statistics& display_statistics() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rayuela
