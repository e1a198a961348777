#pragma once

#include "core/math/ray.h"
#include "core/math/transform.h"

#include <cmath>

namespace rayuela {

/// A ray in double. Every decision about a hit is made with it, so that no structure, vector width or transform in
/// between changes one.
struct RayD {
    Vec3d origin{0};
    Vec3d direction{0, 0, 1};

    RayD() = default;
    RayD(const Vec3d& o, const Vec3d& d) : origin(o), direction(d) {}
    explicit RayD(const Ray& ray) : origin(ray.origin), direction(ray.direction) {}
    Vec3d at(double t) const { return origin + t * direction; }
};

/// |a - b|^2 - r^2 as if computed in twice the precision of double and then rounded: keeps its digits where a lies on the
/// sphere about b (Dot2 of Ogita, Rump & Oishi, "Accurate sum and dot product", SIAM J. Sci. Comput. 26(6), 2005).
inline double squared_distance_excess(const Vec3d& a, const Vec3d& b, double r) {
    const auto two_sum_error = [](double x, double y, double sum) {
        const double z = sum - x;
        return (x - (sum - z)) + (y - z);
    };
    double sum = -(r * r), errors = -std::fma(r, r, sum);
    for (int axis = 0; axis < 3; ++axis) {
        const double difference = a[axis] - b[axis];
        const double lost = two_sum_error(a[axis], -b[axis], difference);
        const double square = difference * difference;
        const double next = sum + square;
        errors += std::fma(difference, difference, -square) + 2 * difference * lost + two_sum_error(sum, square, next);
        sum = next;
    }
    return sum + errors;
}

/// Affine in double.
struct AffineD {
    glm::dmat3 linear{1};
    Vec3d translation{0};

    AffineD() = default;
    AffineD(const glm::dmat3& l, const Vec3d& t) : linear(l), translation(t) {}
    explicit AffineD(const Affine& a) : linear(a.linear), translation(a.translation) {}
    Vec3d point(const Vec3d& p) const { return linear * p + translation; }
    Vec3d vector(const Vec3d& v) const { return linear * v; }
    /// The direction is not normalised: t means the same in both spaces.
    RayD ray(const RayD& r) const { return {point(r.origin), vector(r.direction)}; }
    AffineD inverse() const {
        const glm::dmat3 inverse_linear = glm::inverse(linear);
        return {inverse_linear, -(inverse_linear * translation)};
    }
};

}  // namespace rayuela
