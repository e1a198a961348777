#pragma once

#include "ui/camera_control.h"
#include "ui/display.h"
#include "ui/editor.h"
#include "ui/gizmo.h"

namespace rayuela {

/// The window that shows the image being rendered: toolbar, image, status line.
class Viewport {
public:
    void draw(Editor& editor);
    /// Something goes on that no event will announce, so that another frame must follow soon.
    bool is_animating() const { return control_.is_flying() || resizing_; }
    const Display& display() const { return display_; }

private:
    void draw_image(Editor& editor, const Vec2& size);
    void draw_overlays(Editor& editor);
    void fit_film(Editor& editor);

    Display display_;
    Gizmo gizmo_;
    CameraControl control_;
    Canvas canvas_;
    glm::ivec2 hovered_pixel_{-1};
    glm::ivec2 wanted_film_{0};
    double wanted_since_ = 0;
    bool resizing_ = false;
};

}  // namespace rayuela
