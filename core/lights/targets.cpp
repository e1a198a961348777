#include "core/lights/targets.h"

#include "core/math/basis.h"
#include "core/math/bounds.h"
#include "core/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace rayuela {
namespace {

/// 1 - cos of the half angle under which a ball is seen; nothing from within.
std::optional<float> cap_of(const Vec3& p, const Vec3& center, float radius2) {
    const Vec3 d = center - p;
    const float sin2 = radius2 / glm::dot(d, d);
    if (!(sin2 < 1)) return std::nullopt;
    return sin2 / (1 + std::sqrt(1 - sin2));
}

Bounds3 bounds_of(const Ball& ball) {
    return {ball.center - ball.radius, ball.center + ball.radius};
}

/// A ball around all of them.
Ball join(std::span<const Ball> balls) {
    if (balls.size() == 1) return balls[0];
    Bounds3 bounds;
    for (const Ball& ball : balls) bounds.extend(bounds_of(ball));
    if (!is_finite(bounds.lo) || !is_finite(bounds.hi)) return {Vec3(0), kInfinity};
    Ball all{bounds.center(), 0};
    for (const Ball& ball : balls) {
        all.radius = std::max(all.radius, glm::length(ball.center - all.center) + ball.radius);
    }
    return all;
}

/// Cuts the part of the largest ball in two at the median, again and again.
std::vector<Ball> gather(std::vector<Ball> balls) {
    std::vector<std::span<Ball>> parts{balls};
    while (parts.size() < std::min(balls.size(), kClusters)) {
        const auto largest = std::ranges::max_element(
            parts, {}, [](std::span<const Ball> part) { return part.size() > 1 ? join(part).radius : -1.0f; });
        const std::span<Ball> part = *largest;
        Bounds3 centers;
        for (const Ball& ball : part) centers.extend(ball.center);
        const int axis = centers.longest_axis();
        const std::size_t half = part.size() / 2;
        std::ranges::nth_element(part, part.begin() + static_cast<std::ptrdiff_t>(half), {},
                                 [&](const Ball& ball) { return ball.center[axis]; });
        *largest = part.first(half);
        parts.push_back(part.subspan(half));
    }
    std::vector<Ball> result;
    for (const std::span<Ball> part : parts) result.push_back(join(part));
    return result;
}

LightClusters clusters_of(const std::vector<Ball>& balls) {
    LightClusters clusters;
    clusters.radius2.fill(1);  // no 0 / 0 where there is no ball
    clusters.cos_spread.fill(-1);
    for (std::size_t i = 0; i < balls.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) clusters.center[static_cast<std::size_t>(axis)][i] = balls[i].center[axis];
        const float radius2 = balls[i].radius * balls[i].radius;
        clusters.radius2[i] = clusters.power[i] = std::min(radius2, std::numeric_limits<float>::max());
    }
    return clusters;
}

}  // namespace

Targets::Targets(std::vector<Ball> balls) : balls_(gather(std::move(balls))), clusters_(clusters_of(balls_)) {}

TargetView::TargetView(const Targets& targets, const Vec3& p, const Vec3& normal)
    : clusters_(targets.clusters_), p_(p), normal_(normal), weights_(light_importance({p, normal}, clusters_)) {
    total_ = std::accumulate(weights_.begin(), weights_.end(), 0.0f);
    if (!(total_ < kInfinity)) total_ = 0;
}

Vec3 TargetView::center(std::size_t i) const {
    return {clusters_.center[0][i], clusters_.center[1][i], clusters_.center[2][i]};
}

Vec3 TargetView::sample(float u_target, const Vec2& u) const {
    float rest = u_target * total_;
    std::size_t target = 0;
    for (std::size_t i = 0; i < kClusters; ++i) {
        if (weights_[i] == 0) continue;
        target = i;
        if (rest < weights_[i]) break;
        rest -= weights_[i];
    }
    const auto cap = cap_of(p_, center(target), clusters_.radius2[target]);
    if (!cap) return Basis(normal_).to_world(sample_cosine_hemisphere(u));
    return Basis(glm::normalize(center(target) - p_)).to_world(sample_uniform_cone(u, *cap));
}

float TargetView::pdf(const Vec3& w) const {
    const float cosine = glm::dot(normal_, w);
    if (!(cosine > 0 && total_ > 0)) return 0;
    float sum = 0;
    for (std::size_t i = 0; i < kClusters; ++i) {
        if (weights_[i] == 0) continue;
        if (const auto cap = cap_of(p_, center(i), clusters_.radius2[i])) {
            // 1 - cos from the chord between unit directions: exact for narrow cones.
            const Vec3 chord = w - glm::normalize(center(i) - p_);
            if (0.5f * glm::dot(chord, chord) <= *cap) sum += weights_[i] * uniform_cone_pdf(*cap);
        } else {
            sum += weights_[i] * kInvPi * cosine;
        }
    }
    return sum / total_;
}

}  // namespace rayuela
