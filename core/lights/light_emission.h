#pragma once

#include "core/lights/light_table.h"
#include "core/lights/targets.h"
#include "core/math/distribution.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rayuela {

/// A ray that has left a light.
struct EmittedRay {
    Ray ray;
    Color power{0};    ///< Radiance times cosine over density: what the ray stands for.
    float pdf = 0;     ///< Per area on the light and solid angle, the choice of the light included. Positive.
    float cosine = 0;  ///< Between ray and surface, positive.
};

/// Draws rays that leave the lights of a table towards given targets: a light by its power and how large the targets look
/// from it, a point evenly over its area, a target by how large it looks from there, a direction evenly in the cone that it
/// fills. Environments are left out. Immutable.
class LightEmission {
public:
    /// Many targets are gathered into few. Empty when there are none, or no light shines towards them.
    LightEmission(std::shared_ptr<const LightTable> table, std::vector<Ball> targets);

    /// The same, where the objects of the table have other numbers, see LightTable::renumbered.
    LightEmission renumbered(std::shared_ptr<const LightTable> table) const;

    const Targets& targets() const { return targets_; }
    bool empty() const { return choice_.empty(); }
    /// Whether both draw from as many lights with the same probabilities, but for rounding.
    bool draws_like(const LightEmission& other) const;
    /// The share of the directions around a target in which a lamp lies, so the chance that a path scattered by one finds a
    /// lamp: the harmonic mean over lamps and targets, weighed by the light they exchange, as noise goes with its inverse.
    float lamp_share() const { return lamp_share_; }
    /// `u_light` chooses the light, `u_target` the target; all numbers in [0, 1). Nothing where the light is dark.
    std::optional<EmittedRay> sample(float u_light, const Vec2& u_point, float u_target, const Vec2& u_direction) const;
    /// Density (see EmittedRay::pdf) with which `sample` draws the ray along unit `w` from `point` of a surface that was
    /// hit there, with unit front normal `ng`.
    float pdf(const Hit& hit, const Vec3& point, const Vec3& ng, const Vec3& w) const;
    std::uint64_t memory_bytes() const { return sizeof(*this) + choice_.memory_bytes(); }

private:
    std::shared_ptr<const LightTable> table_;
    Targets targets_;
    AliasTable choice_;  ///< Over the lights of the table.
    float lamp_share_ = 1;
};

}  // namespace rayuela
