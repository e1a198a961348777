#pragma once

#include "core/scene/scene.h"
#include "ui/view_settings.h"

#include <optional>

namespace rayuela {

class Editor;

/// Where handles for an object stand, in its own space: the centre of what it shows, a plane's point.
Vec3 gizmo_pivot(const Scene& scene, const Object& object);

/// The object placed so that its own space goes to `world`: of translation, rotation and scale only what `mode` is about
/// changes, so that the others keep their exact values. Planes do not scale.
Object placed(const Scene& scene, const Object& object, const Affine& world, GizmoMode mode);

/// World to camera, and camera to clip space for depths that suit the camera's distance to its target.
Mat4 view_matrix(const Camera& camera);
Mat4 projection_matrix(const Camera& camera, float aspect);

/// The handles by which the selected object is moved, turned and scaled in the viewport.
class Gizmo {
public:
    /// Draws into the current window; the rectangle is the image's, in ImGui's coordinates. True while the mouse is over
    /// it or holds it. To be called before the items of the image, which would keep the mouse from it.
    bool draw(Editor& editor, const Vec2& corner, const Vec2& size);

private:
    std::optional<Vec3> held_pivot_;  ///< Stays while the mouse holds it: a group's centre moves as it turns.
};

}  // namespace rayuela
