#pragma once

#include "core/math/ray.h"
#include "core/math/transform.h"

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
