#pragma once

#include "core/math/bounds.h"
#include "core/scene/camera.h"
#include "core/scene/scene.h"

#include <optional>
#include <span>

namespace rayuela {

/// A view along an axis, as Blender's number pad has them.
struct AxisView {
    const char* name;
    Vec3 direction;  ///< In which the camera looks.
    Vec3 up;
};
std::span<const AxisView> axis_views();

/// The camera turned to look that way at the same target from the same distance.
Camera looking_along(const Camera& camera, const AxisView& view);
/// The camera moved along its own view direction so that the bounds fill an image of this aspect (width / height); its
/// target becomes their centre. Empty bounds change nothing.
Camera framing(const Camera& camera, const Bounds3& bounds, float aspect);
/// The camera with the plane of focus through a point; unchanged where the point lies behind it.
Camera focused_on(const Camera& camera, const Vec3& point);
/// Bounds of the object (of a plane: of a unit box around its point), else of all that is visible.
Bounds3 bounds_to_frame(const Scene& scene, std::optional<ObjectId> id);

}  // namespace rayuela
