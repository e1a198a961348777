#pragma once

#include "core/math/bounds.h"
#include "core/math/vec.h"

#include <optional>

namespace rayuela {

/// x -> linear * x + translation.
struct Affine {
    Mat3 linear{1};
    Vec3 translation{0};

    Vec3 point(const Vec3& p) const { return linear * p + translation; }
    Vec3 vector(const Vec3& v) const { return linear * v; }
    /// Composition: (*this * b).point(p) == point(b.point(p)).
    Affine operator*(const Affine& b) const { return {linear * b.linear, linear * b.translation + translation}; }
    /// Computed in double. The linear part must be invertible (see is_invertible).
    Affine inverse() const;
    bool is_invertible() const;
    bool is_identity() const { return linear == Mat3(1) && translation == Vec3(0); }
    bool operator==(const Affine&) const = default;
    /// Bounds of the transformed box's corners.
    Bounds3 bounds(const Bounds3& box) const;
};

/// How a person places an object: scale, then rotate, then translate; or one matrix (its last row is 0 0 0 1).
struct Transform {
    Vec3 translate{0};
    Quat rotate{1, 0, 0, 0};  ///< Unit quaternion (w, x, y, z).
    Vec3 scale{1};
    std::optional<Mat4> matrix;  ///< When set it replaces the three above.

    Affine affine() const;
    bool operator==(const Transform&) const = default;
};

}  // namespace rayuela
