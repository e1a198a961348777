#include "core/lights/light_table.h"

#include "core/lights/light_builder.h"
#include "core/math/float_error.h"

#include <algorithm>

namespace rayuela {

LightTable::LightTable(std::span<const GeometryInstance> instances, std::span<const Material* const> materials,
                       const Environment& environment) {
    std::vector<std::uint32_t> first_light(instances.size(), kNone);
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(lights_.size());
        append_lights(instances[i], *materials[i], lights_);
        if (lights_.size() > first) first_light[i] = first;
    }
    std::vector<float> powers;
    for (const AreaLight& light : lights_) powers.push_back(light.power());
    by_power_ = AliasTable(powers);
    if (by_power_.empty()) lights_.clear();
    if (!by_power_.empty()) first_light_ = std::move(first_light);
    lights_.shrink_to_fit();

    const EnvironmentLight light(environment);
    if (!light.image()) return;
    auto distribution = std::make_shared<const EnvironmentDistribution>(light);
    if (distribution->empty()) return;
    environment_ = std::move(distribution);
    // How much of a panorama reaches a point depends on the scene as lamps do; an even share is never off by much.
    environment_probability_ = lights_.empty() ? 1.0f : 0.5f;
}

AliasTable::Draw LightTable::select(const Vec3&, float u) const {
    return by_power_.draw(u);
}

float LightTable::selection_probability(const Vec3&, std::uint32_t light) const {
    return by_power_.probability(light);
}

std::optional<LightSample> LightTable::sample(const Vec3& p, float u_select, const Vec2& u) const {
    const float share = 1 - environment_probability_;
    if (u_select < environment_probability_) return sample_environment(u);
    const float rest = (u_select - environment_probability_) / share;
    return sample_area_light(p, select(p, std::min(rest, 1 - kUnitRoundoff)), u);
}

std::optional<LightSample> LightTable::sample(const Vec3& p, const Vec2& u) const {
    const float share = 1 - environment_probability_;
    if (u.x < environment_probability_) return sample_environment({u.x / environment_probability_, u.y});
    const float rest = (u.x - environment_probability_) / share;
    const AliasTable::Draw draw = select(p, std::min(rest, 1 - kUnitRoundoff));
    return sample_area_light(p, draw, {draw.remainder, u.y});
}

std::optional<LightSample> LightTable::sample_environment(const Vec2& u) const {
    auto s = environment_->sample(u);
    if (s) s->pdf *= environment_probability_;
    return s;
}

std::optional<LightSample> LightTable::sample_area_light(const Vec3& p, const AliasTable::Draw& draw,
                                                         const Vec2& u) const {
    auto s = lights_[draw.index].sample(p, u);
    if (s) s->pdf *= (1 - environment_probability_) * draw.probability;
    return s && s->pdf > 0 ? s : std::nullopt;
}

float LightTable::pdf(const Vec3& p, const Vec3& wi, const Hit& hit, const Vec3& hit_point, const Vec3& ng) const {
    if (hit.object >= first_light_.size() || first_light_[hit.object] == kNone) return 0;
    const std::uint32_t light = first_light_[hit.object] + hit.primitive;
    const float selection = selection_probability(p, light);
    if (selection == 0) return 0;
    return (1 - environment_probability_) * selection * lights_[light].pdf(p, wi, hit_point, ng);
}

float LightTable::environment_pdf(const Vec3& wi) const {
    return environment_ ? environment_probability_ * environment_->pdf(wi) : 0.0f;
}

std::uint64_t LightTable::memory_bytes() const {
    return lights_.capacity() * sizeof(AreaLight) + first_light_.capacity() * sizeof(std::uint32_t) +
           by_power_.memory_bytes() + (environment_ ? environment_->memory_bytes() : 0);
}

}  // namespace rayuela
