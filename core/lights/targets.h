#pragma once

#include "core/lights/light_importance.h"
#include "core/math/vec.h"

#include <span>
#include <vector>

namespace rayuela {

/// A solid ball.
struct Ball {
    Vec3 center{0};
    float radius = 0;  ///< May be infinite: everywhere.
};

/// Things worth aiming at, as seen from one point of a surface: draws directions into the half space of its normal, first
/// a target by how large it looks, then evenly in the cone that it fills; by the cosine from within a target.
class TargetView;

/// Balls around things worth aiming at; many are gathered into few. Immutable.
class Targets {
public:
    explicit Targets(std::vector<Ball> balls);

    /// The balls that are aimed at, kClusters at most.
    std::span<const Ball> balls() const { return balls_; }

private:
    friend class TargetView;
    std::vector<Ball> balls_;
    LightClusters clusters_;
};

class TargetView {
public:
    /// `normal` is unit.
    TargetView(const Targets& targets, const Vec3& p, const Vec3& normal);

    /// Estimate of how much of the half space the targets fill, weighed by the cosine; 0 if none reaches into it.
    float extent() const { return total_; }
    /// Where extent() is positive. `u_target` in [0, 1). The direction may lie below the surface: then its pdf is 0.
    Vec3 sample(float u_target, const Vec2& u) const;
    /// Density per solid angle with which `sample` draws the unit direction.
    float pdf(const Vec3& w) const;

private:
    Vec3 center(std::size_t i) const;

    const LightClusters& clusters_;
    Vec3 p_, normal_;
    LightClusters::Lanes<float> weights_;
    float total_;
};

}  // namespace rayuela
