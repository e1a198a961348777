#pragma once

#include "core/lights/rectangle_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

/// Of the square of the distance within which a triangle is close: closer to its plane it is not looked at as such, for the
/// directions to two corners may be nearly opposite.
inline constexpr float kLeastHeight2 = 1.0f / 256;

/// A triangle as seen from the origin. Arvo, "Stratified Sampling of Spherical Triangles", 1995, in the form of Peters, "BRDF
/// Importance Sampling for Polygonal Lights", 2021, section 4: products of the directions to the corners instead of angles
/// between arcs, so that small triangles lose nothing.
class TriangleView {
public:
    /// `height` over the plane: not small beside the triangle.
    TriangleView(const std::array<Vec3, 3>& corners, float area, float height)
        : closeness_{1 / glm::length(corners[0]), 1 / glm::length(corners[1]), 1 / glm::length(corners[2])} {
        const Vec3 a = corners[0] * closeness_[0], b = corners[1] * closeness_[1], c = corners[2] * closeness_[2];
        ab_ = glm::dot(a, b);
        ac_ = glm::dot(a, c);
        bc_ = glm::dot(b, c);
        volume_ = 2 * area * closeness_[1] * closeness_[2] * (height * closeness_[0]);
    }

    /// Van Oosterom & Strackee, "The Solid Angle of a Plane Triangle", 1983.
    float solid_angle() const { return 2 * angle_of((1 + ab_) + (ac_ + bc_), volume_); }

    /// Even over the directions; as shares of the edges from the first corner to the others.
    Vec2 sample(const Vec2& u, float angle) const {
        // The point d where the arc from b to c cuts off u.x of the triangle, twice as far from b as the sum of b and c in
        // these shares.
        const Vec2 w = cos_sin_turns(u.x * angle * (0.25f * kInvPi));
        const float to_b = volume_ * w.x - (ac_ + bc_) * w.y, to_c = (1 + ab_) * w.y;
        const float difference = std::max(to_b - to_c, 0.0f);
        const float scale = 1 / (difference * difference + 2 * to_b * to_c * (1 + bc_));
        const float b = difference * (to_b + to_c) * scale, c = 2 * to_c * (to_b + to_c * bc_) * scale;
        // A point of the arc from a to d: a cosine even between theirs.
        const float ad = b * ab_ + c * ac_, cosine = 1 - u.y * (1 - ad);
        const float d = std::sqrt(u.y * (1 + cosine) / (1 + ad)), a = std::max(cosine - d * ad, 0.0f);
        const float along_b = d * b * closeness_[1], along_c = d * c * closeness_[2];
        const float all = 1 / (a * closeness_[0] + (along_b + along_c));
        return {std::min(along_b * all, 1.0f), std::min(along_c * all, 1.0f)};
    }

private:
    std::array<float, 3> closeness_;  ///< One over the distances of the corners a, b, c.
    float ab_, ac_, bc_;              ///< Cosines between the directions to them.
    float volume_;                    ///< That these span.
};

}  // namespace rayuela
