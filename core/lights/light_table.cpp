#include "core/lights/light_table.h"

#include "core/lights/light_builder.h"
#include "core/math/float_error.h"

#include <algorithm>

namespace rayuela {

LightTable::LightTable(std::span<const GeometryInstance> instances, std::span<const Material* const> materials,
                       const Environment& environment, LightChoice choice) {
    std::vector<std::uint32_t> first_light(instances.size(), kNone);
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(lights_.size());
        append_lights(instances[i], *materials[i], lights_);
        if (lights_.size() > first) first_light[i] = first;
    }
    tree_ = LightTree(lights_, choice);
    if (tree_.empty()) {
        lights_.clear();
    } else {
        first_light_ = std::move(first_light);
    }
    lights_.shrink_to_fit();

    const EnvironmentLight light(environment);
    if (!light.image()) {
        if (choice == LightChoice::arriving) few_ = FewLamps::of(lights_, tree_);
        return;
    }
    auto distribution = std::make_shared<const EnvironmentDistribution>(light);
    if (distribution->empty()) return;
    environment_ = std::move(distribution);
    // How much of a panorama reaches a point depends on the scene as lamps do; an even share is never off by much.
    environment_probability_ = lights_.empty() ? 1.0f : 0.5f;
}

LightTable LightTable::renumbered(std::span<const std::uint32_t> from, std::span<const std::uint32_t> to,
                                  std::size_t objects) const {
    LightTable table = *this;
    if (first_light_.empty()) return table;
    table.first_light_.assign(objects, kNone);
    for (std::size_t i = 0; i < from.size(); ++i) table.first_light_[to[i]] = first_light_[from[i]];
    return table;
}

std::optional<LightSample> LightTable::sample(const LightReceiver& receiver, const Vec2& u) const {
    if (u.x < environment_probability_) return sample_environment({u.x / environment_probability_, u.y});
    const float rest = (u.x - environment_probability_) / (1 - environment_probability_);
    return sample_area_light(receiver, {std::min(rest, 1 - kUnitRoundoff), u.y});
}

void LightTable::sample(LightBlock& block, bool together) const {
    if (few_ && together) {
        few_->sample(block);
        return;
    }
    for (std::size_t i = 0; i < block.size; ++i) {
        const auto light = sample(block.receiver(i), {block.u[i], block.v[i]});
        block.pdf[i] = 0;
        if (light) block.put(i, *light);
    }
}

std::optional<LightSample> LightTable::sample_environment(const Vec2& u) const {
    auto s = environment_->sample(u);
    if (s) s->pdf *= environment_probability_;
    return s;
}

std::optional<LightSample> LightTable::sample_area_light(const LightReceiver& receiver, const Vec2& u) const {
    const std::optional<LightTree::Draw> draw = tree_.draw(receiver, u.x);
    if (!draw) return std::nullopt;
    auto s = lights_[draw->light].sample(receiver, {draw->remainder, u.y});
    if (s) s->pdf *= (1 - environment_probability_) * draw->probability;
    return s && s->pdf > 0 ? s : std::nullopt;
}

float LightTable::pdf(const LightReceiver& receiver, const Vec3& wi, const Hit& hit, const Vec3& hit_point,
                      const Vec3& ng) const {
    const std::uint32_t light = light_of(hit);
    if (light == kNone) return 0;
    const float selection = tree_.probability(receiver, light);
    if (selection == 0) return 0;
    return (1 - environment_probability_) * selection * lights_[light].pdf(receiver, wi, hit_point, ng);
}

float LightTable::environment_pdf(const Vec3& wi) const {
    return environment_ ? environment_probability_ * environment_->pdf(wi) : 0.0f;
}

std::uint64_t LightTable::memory_bytes() const {
    return lights_.capacity() * sizeof(AreaLight) + first_light_.capacity() * sizeof(std::uint32_t) +
           tree_.memory_bytes() + (environment_ ? environment_->memory_bytes() : 0);
}

}  // namespace rayuela
