#include "core/materials/ggx_albedo.h"

#include "core/materials/fresnel.h"
#include "core/materials/microfacet.h"
#include "core/math/sampler.h"

#include <algorithm>
#include <array>

namespace rayuela {
namespace {

constexpr int kSide = 32;
constexpr int kTotalSamples = 256, kGrazingSamples = 128, kAverageSamples = 256;

using Row = std::array<float, kSide>;

/// Linear interpolation at `x` in [0, 1].
float interpolate(const Row& row, float x) {
    const float scaled = x * (kSide - 1);
    const int i = std::clamp(static_cast<int>(scaled), 0, kSide - 2);
    return glm::mix(row[i], row[i + 1], scaled - static_cast<float>(i));
}

/// Deterministic quadrature over the visible normals.
GgxAlbedo integrate(float mu, float alpha, int samples) {
    const Ggx ggx{alpha};
    const Vec3 wo(std::sqrt(1 - mu * mu), 0, mu);
    double total = 0, grazing = 0;
    for (int i = 0; i < samples; ++i) {
        const float half_cell = 0.5f / static_cast<float>(samples);
        const Vec2 u(static_cast<float>(i) / static_cast<float>(samples) + half_cell,
                     to_unit_float(reverse_bits(static_cast<std::uint32_t>(i))) + half_cell);
        const Vec3 m = ggx.sample_visible(wo, u);
        const Vec3 wi = reflect(wo, m);
        if (wi.z <= 0) continue;
        const float weight = ggx.g2_over_g1(wo, wi);
        total += weight;
        grazing += weight * schlick_weight(std::min(glm::dot(wo, m), 1.0f));
    }
    return {static_cast<float>(total / samples), static_cast<float>(grazing / samples)};
}

/// A row for each roughness = sqrt(alpha), at equal steps. The loss of energy depends on mu / alpha near the horizon and
/// on mu elsewhere, Fresnel's effect on mu: so each has its own coordinate.
struct Tables {
    std::array<Row, kSide> total;  ///< Over total_position(mu).
    std::array<Row, kSide> ratio;  ///< grazing / total over sqrt(mu).
    Row average_total, average_grazing;

    static float total_position(float mu, float alpha) { return std::sqrt(mu * (1 + alpha) / (mu + alpha)); }
    static float mu_at(float total_position, float alpha) {
        const float p = total_position * total_position;
        return p * alpha / (1 + alpha - p);
    }

    Tables() {
        for (int j = 0; j < kSide; ++j) {
            const float roughness = static_cast<float>(j) / (kSide - 1);
            const float alpha = std::max(roughness * roughness, kSmoothAlpha);
            for (int i = 0; i < kSide; ++i) {
                const float x = static_cast<float>(i) / (kSide - 1);
                total[j][i] = integrate(std::min(mu_at(x, alpha), 1.0f), alpha, kTotalSamples).total;
                const GgxAlbedo albedo = integrate(x * x, alpha, kGrazingSamples);
                ratio[j][i] = albedo.grazing / albedo.total;
            }
        }
        for (int j = 0; j < kSide; ++j) {
            const float roughness = static_cast<float>(j) / (kSide - 1);
            const float alpha = roughness * roughness;
            double sum_total = 0, sum_grazing = 0;
            for (int i = 0; i < kAverageSamples; ++i) {
                // mu dmu = d(mu^2) / 2: uniform in mu^2.
                const float mu = std::sqrt((static_cast<float>(i) + 0.5f) / kAverageSamples);
                const GgxAlbedo albedo = directional(mu, alpha);
                sum_total += albedo.total;
                sum_grazing += albedo.grazing;
            }
            average_total[j] = static_cast<float>(sum_total / kAverageSamples);
            average_grazing[j] = static_cast<float>(sum_grazing / kAverageSamples);
        }
    }

    GgxAlbedo directional(float mu, float alpha) const {
        const float scaled = std::sqrt(alpha) * (kSide - 1);
        const int j = std::clamp(static_cast<int>(scaled), 0, kSide - 2);
        const float fraction = scaled - static_cast<float>(j);
        const float x = total_position(mu, alpha), y = std::sqrt(mu);
        const float e = glm::mix(interpolate(total[j], x), interpolate(total[j + 1], x), fraction);
        const float s = glm::mix(interpolate(ratio[j], y), interpolate(ratio[j + 1], y), fraction);
        return {e, e * s};
    }
};

const Tables& tables() {
    static const Tables instance;
    return instance;
}

}  // namespace

GgxAlbedo ggx_albedo(float mu, float alpha) {
    mu = clamp_unit(mu);
    if (alpha < kSmoothAlpha) return {1, schlick_weight(mu)};
    return tables().directional(mu, alpha);
}

GgxAlbedo ggx_average_albedo(float alpha) {
    if (alpha < kSmoothAlpha) return {1, 1.0f / 21};
    const float roughness = std::sqrt(alpha);
    return {interpolate(tables().average_total, roughness), interpolate(tables().average_grazing, roughness)};
}

}  // namespace rayuela
