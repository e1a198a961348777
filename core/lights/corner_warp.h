#pragma once

#include "core/lights/light_importance.h"
#include "core/math/ray.h"
#include "core/math/sampling.h"

#include <algorithm>
#include <array>

namespace rayuela {

/// A density over the unit square, bilinear between weights at its corners (0, 0), (1, 0), (0, 1), (1, 1).
/// Hart et al., "Practical Product Sampling by Fitting and Composing Warps", 2020.
struct CornerWarp {
    std::array<float, 4> weights{1, 1, 1, 1};

    /// Maps even numbers to this density.
    Vec2 sample(const Vec2& u) const {
        const float y = sample_linear(u.y, weights[0] + weights[1], weights[2] + weights[3]);
        return {sample_linear(u.x, between(y, 0), between(y, 1)), y};
    }
    /// 1 where it is that of even numbers.
    float density(const Vec2& position) const {
        const float left = between(position.y, 0), right = between(position.y, 1);
        const float mean = 0.25f * ((weights[0] + weights[1]) + (weights[2] + weights[3]));
        return (left + position.x * (right - left)) / mean;
    }

private:
    float between(float y, std::size_t column) const {
        return weights[column] + y * (weights[column + 2] - weights[column]);
    }
};

/// No corner counts for less than this share of the one that counts most: where a corner is below the horizon, or much
/// farther than what is between the corners, light may come from near it all the same.
inline constexpr float kLeastCornerShare = 1.0f / 32;

/// The density of these weights, but for a factor; even where all are 0.
inline CornerWarp corner_warp(const std::array<float, 4>& weights) {
    const auto& [w0, w1, w2, w3] = weights;
    const float scale = 1 / std::max(std::max(w0, w1), std::max(w2, w3));
    if (!(scale < kInfinity)) return {};
    CornerWarp warp;
    for (std::size_t i = 0; i < 4; ++i) warp.weights[i] = std::max(weights[i] * scale, kLeastCornerShare);
    return warp;
}

/// The points `corners` of a lamp, as seen from a receiver at the origin whose half space is that of unit `n` (0: all), by the
/// light a diffuse receiver gets from there: n . d / d^4, but for what is the same all over a plane.
inline CornerWarp corner_warp(const std::array<Vec3, 4>& corners, const Vec3& n) {
    std::array<float, 4> d2{};
    for (std::size_t i = 0; i < 4; ++i) d2[i] = glm::dot(corners[i], corners[i]);
    const float unit = 1 / std::max(std::max(d2[0], d2[1]), std::max(d2[2], d2[3]));
    for (float& distance2 : d2) distance2 *= unit;
    // In proportion to 1 / d^2 without a division a corner: times the product of all.
    const float d01 = d2[0] * d2[1], d23 = d2[2] * d2[3];
    const std::array<float, 4> closeness{d2[1] * d23, d2[0] * d23, d01 * d2[3], d01 * d2[2]};
    const bool facing = !is_black(n);
    std::array<float, 4> weights{};
    for (std::size_t i = 0; i < 4; ++i) {
        const float height = facing ? std::max(glm::dot(n, corners[i]), 0.0f) : 1.0f;
        weights[i] = closeness[i] * closeness[i] * height;
    }
    return unit > 0 && unit < kInfinity ? corner_warp(weights) : CornerWarp{};
}

/// The same for directions to the corners that are mapped to, of which `closeness` is in proportion to one over the distance:
/// n . w.
inline CornerWarp cosine_warp(const std::array<Vec3, 4>& corners, const std::array<float, 4>& closeness,
                              const Vec3& n) {
    if (is_black(n)) return {};
    std::array<float, 4> weights{};
    for (std::size_t i = 0; i < 4; ++i) weights[i] = closeness[i] * std::max(glm::dot(n, corners[i]), 0.0f);
    return corner_warp(weights);
}

}  // namespace rayuela
