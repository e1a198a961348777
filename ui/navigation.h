#pragma once

#include "core/math/bounds.h"
#include "core/scene/camera.h"

namespace rayuela {

/// Ways to move a camera, each from one camera to the next (jumps to a view are in camera_views.h). All keep `up`; none
/// reaches a pole or the target. Where the camera looks along `up`, or at its own position, another direction takes the
/// place of the missing one.

/// Orthonormal directions of the image: forward x up = right.
struct CameraFrame {
    Vec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};
CameraFrame camera_frame(const Camera& camera);

/// Turns the eye around the target: yaw about `up` to the right, pitch upwards, radians.
Camera orbit(const Camera& camera, float yaw, float pitch);
/// Turns the view around the eye: yaw to the right, pitch upwards, radians.
Camera look(const Camera& camera, float yaw, float pitch);
/// Moves eye and target in the image plane, so that what lies at the target's depth follows the mouse. The unit of
/// `delta` is the height of the image; x to the right, y downwards, as the mouse moves.
Camera pan(const Camera& camera, const Vec2& delta);
/// Multiplies the distance to the target.
Camera dolly(const Camera& camera, float factor);
/// Moves eye and target by right, up, forward.
Camera fly(const Camera& camera, const Vec3& motion);
/// A step of flight that suits the scene, world units a second: its extent in a few seconds.
float fly_speed(const Camera& camera, const Bounds3& scene);

}  // namespace rayuela
