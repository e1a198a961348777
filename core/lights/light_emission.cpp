#include "core/lights/light_emission.h"

#include "core/math/float_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

Vec3 middle_of(const AreaLight& light) {
    if (light.kind == AreaLight::Kind::sphere) return light.origin;
    return light.origin + (light.edge_u + light.edge_v) / (light.kind == AreaLight::Kind::triangle ? 3.0f : 2.0f);
}

}  // namespace

LightEmission::LightEmission(std::shared_ptr<const LightTable> table, std::vector<Ball> targets)
    : table_(std::move(table)), targets_(std::move(targets)) {
    std::vector<float> weights;
    double light = 0, noise = 0;
    for (const AreaLight& lamp : table_->lights()) {
        const bool sphere = lamp.kind == AreaLight::Kind::sphere;
        const Vec3 middle = middle_of(lamp);
        const auto extent = [&](const Vec3& normal) { return TargetView(targets_, middle, normal).extent(); };
        const Vec3 front = sphere ? Vec3(0) : lamp.normal;
        weights.push_back(lamp.power() * std::min(1.0f, extent(front) + (lamp.two_sided ? extent(-front) : 0.0f)));
        for (const Ball& ball : targets_.balls()) {
            const Vec3d to_lamp = Vec3d(middle) - Vec3d(ball.center);
            const double distance2 = glm::dot(to_lamp, to_lamp), radius2 = double{ball.radius} * double{ball.radius};
            const double facing = sphere ? 0.25 : std::abs(glm::dot(Vec3d(front), to_lamp)) / std::sqrt(distance2);
            const double share = lamp.area() * facing / (2 * std::numbers::pi * distance2);
            if (!(share > 0) || weights.back() == 0) continue;
            const double exchanged = lamp.power() * facing * std::min(1.0, radius2 / distance2);
            light += exchanged;
            noise += exchanged / (distance2 > radius2 ? std::min(share, 1.0) : 1.0);
        }
    }
    if (noise > 0) lamp_share_ = static_cast<float>(light / noise);
    choice_ = AliasTable(weights);
}

LightEmission LightEmission::renumbered(std::shared_ptr<const LightTable> table) const {
    LightEmission emission = *this;
    emission.table_ = std::move(table);
    return emission;
}

bool LightEmission::draws_like(const LightEmission& other) const {
    constexpr float kRounding = 64 * kUnitRoundoff;
    const std::size_t lights = table_->lights().size();
    if (other.table_->lights().size() != lights) return false;
    for (std::uint32_t i = 0; i < lights; ++i) {
        const float a = choice_.probability(i), b = other.choice_.probability(i);
        if (std::abs(a - b) > kRounding * a) return false;
    }
    return true;
}

std::optional<EmittedRay> LightEmission::sample(float u_light, const Vec2& u_point, float u_target,
                                                const Vec2& u_direction) const {
    const AliasTable::Draw draw = choice_.draw(u_light);
    const AreaLight& light = table_->lights()[draw.index];
    const AreaLight::SurfaceSample at = light.sample_surface(u_point, draw.remainder);
    const TargetView targets(targets_, at.point, at.normal);
    if (targets.extent() == 0) return std::nullopt;
    const Vec3 w = targets.sample(u_target, u_direction);
    EmittedRay result;
    result.cosine = glm::dot(at.normal, w);
    result.pdf = draw.probability * at.pdf * targets.pdf(w);
    if (!(result.pdf > 0 && result.pdf < kInfinity) || is_black(at.radiance)) return std::nullopt;
    result.ray = {.origin = offset_ray_origin(at.point, at.error, at.normal, w), .direction = w};
    result.power = at.radiance * (result.cosine / result.pdf);
    return result;
}

float LightEmission::pdf(const Hit& hit, const Vec3& point, const Vec3& ng, const Vec3& w) const {
    const std::uint32_t index = table_->light_of(hit);
    if (index == kNone) return 0;
    const AreaLight& light = table_->lights()[index];
    const Vec3 normal = glm::dot(ng, w) < 0 ? -ng : ng;
    if (normal != ng && !light.two_sided) return 0;
    const float side = light.two_sided ? 0.5f : 1.0f;
    return choice_.probability(index) * side / light.area() * TargetView(targets_, point, normal).pdf(w);
}

}  // namespace rayuela
