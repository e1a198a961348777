#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cstdint>

namespace rayuela {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Vec3d = glm::dvec3;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using Quat = glm::quat;
/// Linear sRGB, unbounded above, never negative.
using Color = glm::vec3;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 0.31830988618379067154f;

inline float max_component(const Vec3& v) {
    return glm::max(v.x, glm::max(v.y, v.z));
}

/// Relative luminance (Rec. 709) of a linear sRGB colour.
inline float luminance(const Color& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

inline bool is_black(const Color& c) {
    return c.x == 0 && c.y == 0 && c.z == 0;
}

inline bool is_finite(const Vec3& v) {
    return glm::all(glm::lessThan(glm::abs(v), Vec3(INFINITY)));
}

}  // namespace rayuela
