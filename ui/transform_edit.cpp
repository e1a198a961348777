#include "ui/transform_edit.h"

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

Mat4 to_mat4(const Affine& affine) {
    Mat4 matrix(affine.linear);
    matrix[3] = Vec4(affine.translation, 1);
    return matrix;
}

}  // namespace

std::optional<Transform> decomposed(const Affine& affine) {
    Transform transform;
    transform.translate = affine.translation;
    Mat3 rotation = affine.linear;
    for (int axis = 0; axis < 3; ++axis) {
        transform.scale[axis] = glm::length(rotation[axis]);
        if (!(transform.scale[axis] > 0)) return std::nullopt;
        rotation[axis] /= transform.scale[axis];
    }
    if (glm::determinant(rotation) < 0) {
        transform.scale.x = -transform.scale.x;
        rotation[0] = -rotation[0];
    }
    // Shear shows as axes that are not perpendicular; what rounding leaves stays far below this.
    constexpr float kPerpendicular = 1e-4f;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(glm::dot(rotation[axis], rotation[(axis + 1) % 3])) > kPerpendicular) return std::nullopt;
    }
    transform.rotate = glm::normalize(glm::quat_cast(rotation));
    return transform;
}

Transform transform_from(const Affine& affine) {
    if (auto transform = decomposed(affine)) return *transform;
    Transform transform;
    transform.matrix = to_mat4(affine);
    return transform;
}

Quat rotation_from_degrees(const Vec3& degrees) {
    const Vec3 r = glm::radians(degrees);
    return glm::normalize(glm::angleAxis(r.z, Vec3(0, 0, 1)) * glm::angleAxis(r.y, Vec3(0, 1, 0)) *
                          glm::angleAxis(r.x, Vec3(1, 0, 0)));
}

Vec3 degrees_from_rotation(const Quat& rotation) {
    const Mat3 m = glm::mat3_cast(rotation);
    const float sin_y = std::clamp(-m[0][2], -1.0f, 1.0f);
    // At the poles x and z turn about the same axis: all of it goes to x.
    constexpr float kPole = 0.99999f;
    if (std::abs(sin_y) > kPole) {
        const float y = std::copysign(kPi / 2, sin_y);
        return glm::degrees(Vec3(std::atan2(sin_y * m[1][0], m[1][1]), y, 0));
    }
    return glm::degrees(Vec3(std::atan2(m[1][2], m[2][2]), std::asin(sin_y), std::atan2(m[0][1], m[0][0])));
}

}  // namespace rayuela
