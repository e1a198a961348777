#pragma once

#include "core/math/vec.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>

/// Signed distances (negative inside) to model with. Only correctly rounded operations (+ - * / sqrt), so that a model is
/// the same to the last bit on every machine.
namespace rayuela::assets {

inline double sphere(const Vec3d& p, const Vec3d& center, double radius) {
    return glm::length(p - center) - radius;
}

/// Approximate away from the surface, exact on it.
inline double ellipsoid(const Vec3d& p, const Vec3d& center, const Vec3d& radii) {
    const Vec3d scaled = (p - center) / radii;
    const double k = glm::length(scaled);
    const double gradient = glm::length(scaled / radii);
    return gradient > 0 ? k * (k - 1) / gradient : -std::min({radii.x, radii.y, radii.z});
}

/// The hull of spheres of radius `ra` at `a` and `rb` at `b` (its sides taken as straight in the radius).
inline double round_cone(const Vec3d& p, const Vec3d& a, double ra, const Vec3d& b, double rb) {
    const Vec3d axis = b - a;
    const double t = std::clamp(glm::dot(p - a, axis) / glm::dot(axis, axis), 0.0, 1.0);
    return glm::length(p - (a + t * axis)) - (ra + t * (rb - ra));
}

/// Union with a fillet about `k` wide (polynomial smooth minimum).
inline double smooth_union(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k * 0.25;
}

inline double smooth_intersection(double a, double b, double k) {
    return -smooth_union(-a, -b, k);
}

inline double smooth_subtraction(double a, double cut, double k) {
    return smooth_intersection(a, -cut, k);
}

/// `p` turned about the x axis through `center`: by the angle whose cosine and sine are given.
inline Vec3d pitched(const Vec3d& p, const Vec3d& center, double cosine, double sine) {
    const Vec3d q = p - center;
    return center + Vec3d(q.x, cosine * q.y - sine * q.z, sine * q.y + cosine * q.z);
}

}  // namespace rayuela::assets
