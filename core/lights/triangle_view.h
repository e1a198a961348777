#pragma once

#include "core/lights/rectangle_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

/// Of the square of the distance within which a triangle is close: closer to its plane it is not looked at as such, for the
/// directions to two corners may be nearly opposite.
inline constexpr float kLeastHeight2 = kLeastHeight * kLeastHeight / (kClose * kClose);

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

    /// The numbers that `sample` maps to this position.
    Vec2 numbers_of(const Vec2& position, float angle) const {
        const float a = std::max(1 - position.x - position.y, 0.0f);
        const float b = position.x * (closeness_[0] / closeness_[1]), c = position.y * (closeness_[0] / closeness_[2]);
        const float d = std::sqrt(b * b + c * c + 2 * b * c * bc_);
        if (!(d > 0)) return Vec2(0);
        const float ad = (b * ab_ + c * ac_) / d, bd = (b + c * bc_) / d;
        const float part = 2 * angle_of((1 + ab_) + (ad + bd), volume_ * (c / d));
        const float all = std::sqrt((a - d) * (a - d) + 2 * a * d * (1 + ad)), cosine = (a + d * ad) / all;
        return glm::clamp(Vec2(part / angle, d * d * (1 + ad) / (all * all * (1 + cosine))), 0.0f, 1.0f);
    }

    /// In proportion to one over the distance of the corners that (0, 0), (1, 0), (0, 1), (1, 1) are mapped to.
    std::array<float, 4> closeness() const { return {closeness_[0], closeness_[0], closeness_[1], closeness_[2]}; }

private:
    std::array<float, 3> closeness_;  ///< One over the distances of the corners a, b, c.
    float ab_, ac_, bc_;              ///< Cosines between the directions to them.
    float volume_;                    ///< That these span.
};

}  // namespace rayuela
