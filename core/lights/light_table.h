#pragma once

#include "core/accel/accelerator.h"
#include "core/lights/area_light.h"
#include "core/lights/environment_distribution.h"
#include "core/lights/few_lamps.h"
#include "core/lights/light_block.h"
#include "core/lights/light_sample.h"
#include "core/lights/light_tree.h"
#include "core/materials/material.h"
#include "core/scene/environment.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rayuela {

/// All lights that can be sampled: emissive spheres (outside or inside), triangles, quads, box faces, mesh triangles, and
/// an environment image. Left out, and so found by scattered rays alone, with pdf 0: infinite planes, spheres that their
/// transform turns into ellipsoids, and constant and gradient environments, which are so smooth that scattering finds
/// them as well as sampling would, without shadow rays. Immutable; keeps no reference to what it was built from.
class LightTable {
public:
    LightTable() = default;
    /// materials[i] belongs to instances[i] and is never null.
    LightTable(std::span<const GeometryInstance> instances, std::span<const Material* const> materials,
               const Environment& environment, LightChoice choice = LightChoice::arriving);

    /// The same lights, where the object that had number from[i] has number to[i] now, of `objects` in all.
    LightTable renumbered(std::span<const std::uint32_t> from, std::span<const std::uint32_t> to,
                          std::size_t objects) const;

    /// Whether there is nothing to sample: then `sample` must not be called, and the table owns no memory.
    bool empty() const { return lights_.empty() && !environment_; }

    /// A direction from the receiver towards a light: u.x chooses the light, and what that leaves of it and u.y the point.
    /// Where `u` is stratified, so are the points of each light. Nothing where the point does not shine towards it.
    std::optional<LightSample> sample(const LightReceiver& receiver, const Vec2& u) const;

    /// The same for many points, to the last bit: one by one, or all together where the lights allow it.
    void sample(LightBlock& block, bool together = true) const;
    /// Whether they do.
    bool samples_together() const { return few_.has_value(); }

    /// Density per solid angle with which `sample` draws the unit direction `wi`, which hits the surface `hit` at
    /// `hit_point` (unit geometric normal `ng` of the front). 0 where it would not.
    float pdf(const LightReceiver& receiver, const Vec3& wi, const Hit& hit, const Vec3& hit_point,
              const Vec3& ng) const;
    /// The same for a direction that hits nothing.
    float environment_pdf(const Vec3& wi) const;

    /// The lights but for the environment.
    std::span<const AreaLight> lights() const { return lights_; }
    /// Which of `lights` the surface `hit` is, or kNone.
    std::uint32_t light_of(const Hit& hit) const {
        if (hit.object >= first_light_.size() || first_light_[hit.object] == kNone) return kNone;
        return first_light_[hit.object] + hit.primitive;
    }

    /// Lights that can be drawn, an environment image among them.
    std::size_t size() const { return lights_.size() + (environment_ ? 1 : 0); }
    std::uint64_t memory_bytes() const;

private:
    std::optional<LightSample> sample_environment(const Vec2& u) const;
    std::optional<LightSample> sample_area_light(const LightReceiver& receiver, const Vec2& u) const;

    std::vector<AreaLight> lights_;           ///< Those of an object lie together, in the order of its primitives.
    std::vector<std::uint32_t> first_light_;  ///< Of an object, or kNone.
    LightTree tree_;                          ///< Over lights_, without the environment.
    std::optional<FewLamps> few_;             ///< Where these are all and nothing more.
    std::shared_ptr<const EnvironmentDistribution> environment_;
    float environment_probability_ = 0;
};

}  // namespace rayuela
