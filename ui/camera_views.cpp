#include "ui/camera_views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

std::span<const AxisView> axis_views() {
    static const std::array<AxisView, 6> kViews{{
        {"Front", {0, 0, -1}, {0, 1, 0}},
        {"Back", {0, 0, 1}, {0, 1, 0}},
        {"Right", {-1, 0, 0}, {0, 1, 0}},
        {"Left", {1, 0, 0}, {0, 1, 0}},
        {"Top", {0, -1, 0}, {0, 0, -1}},
        {"Bottom", {0, 1, 0}, {0, 0, 1}},
    }};
    return kViews;
}

Camera looking_along(const Camera& camera, const AxisView& view) {
    Camera result = camera;
    result.position = camera.target - glm::distance(camera.position, camera.target) * view.direction;
    result.up = view.up;
    return result;
}

Camera framing(const Camera& camera, const Bounds3& bounds, float aspect) {
    if (bounds.empty()) return camera;
    // A little air around the sphere that holds the bounds.
    constexpr float kMargin = 1.1f;
    const float half_vertical = glm::radians(camera.vfov) / 2;
    const float half_angle = std::atan(std::tan(half_vertical) * std::min(1.0f, aspect));
    const float radius = 0.5f * glm::length(bounds.extent());
    const Vec3 view = camera.target - camera.position;
    const Vec3 direction = glm::length(view) > 0 ? glm::normalize(view) : Vec3(0, 0, -1);
    const float distance = radius > 0 ? kMargin * radius / std::sin(half_angle) : glm::length(view);

    Camera result = camera;
    result.target = bounds.center();
    result.position = result.target - distance * direction;
    result.focus_distance = distance;
    return result;
}

Camera focused_on(const Camera& camera, const Vec3& point) {
    Camera result = camera;
    const Vec3 view = glm::normalize(camera.target - camera.position);
    const float distance = glm::dot(point - camera.position, view);
    if (distance > 0) result.focus_distance = distance;
    return result;
}

Bounds3 bounds_to_frame(const Scene& scene, std::optional<ObjectId> id) {
    const Object* object = id ? scene.find(*id) : nullptr;
    if (!object) return world_bounds(scene);
    if (const Plane* plane = std::get_if<Plane>(&object->shape)) {
        const Vec3 center = scene.to_world(object->id).point(plane->point);
        return {center - 0.5f, center + 0.5f};
    }
    return world_bounds(scene, object->id);
}

}  // namespace rayuela
