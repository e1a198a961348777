#include "ui/navigation.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// Closest that the view comes to `up`, radians.
constexpr float kPoleAngle = 0.02f;

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
    const float length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

Vec3 unit_up(const Camera& camera) {
    return unit_or(camera.up, Vec3(0, 1, 0));
}

Vec3 view_direction(const Camera& camera) {
    return unit_or(camera.target - camera.position, Vec3(0, 0, -1));
}

Vec3 rotated(const Vec3& v, float angle, const Vec3& axis) {
    return glm::angleAxis(angle, axis) * v;
}

/// `direction` turned to the right about `up` and upwards, kept away from the poles.
Vec3 turned(const Camera& camera, const Vec3& direction, float yaw, float pitch) {
    const Vec3 up = unit_up(camera);
    const Vec3 right = camera_frame(camera).right;
    // Clamped only towards a pole, so that a view set beside it by hand does not jump at the first touch.
    const float angle = std::acos(glm::clamp(glm::dot(direction, up), -1.0f, 1.0f));
    const float least = std::min(kPoleAngle, angle), most = std::max(kPi - kPoleAngle, angle);
    const float pitched = angle - glm::clamp(angle - pitch, least, most);
    return rotated(rotated(direction, pitched, right), -yaw, up);
}

}  // namespace

CameraFrame camera_frame(const Camera& camera) {
    CameraFrame frame;
    frame.forward = view_direction(camera);
    const Vec3 side = glm::cross(frame.forward, unit_up(camera));
    const Vec3 axis = std::abs(frame.forward.x) < 0.9f ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
    const bool at_pole = glm::dot(side, side) < 1e-10f;
    frame.right = glm::normalize(at_pole ? glm::cross(frame.forward, glm::cross(axis, frame.forward)) : side);
    frame.up = glm::cross(frame.right, frame.forward);
    return frame;
}

Camera orbit(const Camera& camera, float yaw, float pitch) {
    Camera result = camera;
    const float distance = glm::distance(camera.position, camera.target);
    // The eye moves to one side where the view turns to the other.
    result.position = camera.target - distance * turned(camera, view_direction(camera), -yaw, -pitch);
    return result;
}

Camera look(const Camera& camera, float yaw, float pitch) {
    Camera result = camera;
    const float distance = glm::distance(camera.position, camera.target);
    result.target = camera.position + distance * turned(camera, view_direction(camera), yaw, pitch);
    return result;
}

Camera pan(const Camera& camera, const Vec2& delta) {
    const CameraFrame frame = camera_frame(camera);
    const float distance = glm::distance(camera.position, camera.target);
    const float image_height = 2 * distance * std::tan(glm::radians(camera.vfov) / 2);
    const Vec3 motion = image_height * (delta.y * frame.up - delta.x * frame.right);
    Camera result = camera;
    result.position += motion;
    result.target += motion;
    return result;
}

Camera dolly(const Camera& camera, float factor) {
    Camera result = camera;
    const Vec3 position = camera.target + factor * (camera.position - camera.target);
    if (position != camera.target && is_finite(position)) result.position = position;
    return result;
}

Camera fly(const Camera& camera, const Vec3& motion) {
    const CameraFrame frame = camera_frame(camera);
    const Vec3 world = motion.x * frame.right + motion.y * unit_up(camera) + motion.z * frame.forward;
    Camera result = camera;
    result.position += world;
    result.target += world;
    return result;
}

float fly_speed(const Camera& camera, const Bounds3& scene) {
    const float to_target = glm::distance(camera.position, camera.target);
    const float extent = glm::length(scene.extent());
    // From far away the scene comes near in a few seconds; close to a detail one is not thrown past it.
    constexpr float kExtentsPerSecond = 0.25f, kTargetsPerSecond = 1;
    const float by_target = kTargetsPerSecond * to_target;
    return extent > 0 ? std::min(kExtentsPerSecond * extent, by_target) : by_target;
}

}  // namespace rayuela
