#include "core/materials/ggx_albedo.h"

#include "core/materials/fresnel.h"
#include "core/materials/microfacet.h"

#include <algorithm>
#include <array>

namespace rayuela {
namespace {

constexpr int kSide = 32;
constexpr int kAverageSamples = 256;

using Row = std::array<float, kSide>;

/// Linear interpolation at `x` in [0, 1].
float interpolate(const Row& row, float x) {
    const float scaled = x * (kSide - 1);
    const int i = std::clamp(static_cast<int>(scaled), 0, kSide - 2);
    return glm::mix(row[i], row[i + 1], scaled - static_cast<float>(i));
}

/// Midpoints over the visible normals: half a turn, since the other half mirrors it, and strata of the spherical cap that
/// are narrower the closer to the horizon light leaves.
GgxAlbedo integrate(float mu, float alpha) {
    constexpr int kTurns = 12, kStrata = 24;
    const Ggx ggx{alpha};
    const Vec3 wo(std::sqrt(1 - mu * mu), 0, mu);
    double total = 0, grazing = 0;
    for (int j = 0; j < kStrata; ++j) {
        const float rest = 1 - (static_cast<float>(j) + 0.5f) / kStrata;
        for (int i = 0; i < kTurns; ++i) {
            const Vec3 m = ggx.sample_visible(wo, Vec2((static_cast<float>(i) + 0.5f) / (2 * kTurns), 1 - rest * rest));
            const Vec3 wi = reflect(wo, m);
            if (wi.z <= 0) continue;
            const float weight = 2 * rest * ggx.g2_over_g1(wo, wi);
            total += weight;
            grazing += weight * schlick_weight(std::min(glm::dot(wo, m), 1.0f));
        }
    }
    constexpr int kSamples = kTurns * kStrata;
    return {static_cast<float>(total / kSamples), static_cast<float>(grazing / kSamples)};
}

/// A row for each roughness = sqrt(alpha), from the least that is not smooth, closest together there. The loss of energy
/// depends on mu / alpha near the horizon and on mu elsewhere, Fresnel's effect on mu: so each has its own coordinate.
struct Tables {
    std::array<Row, kSide> total;  ///< Over total_position(mu).
    std::array<Row, kSide> ratio;  ///< grazing / total over sqrt(mu).
    Row average_total, average_grazing;

    static float total_position(float mu, float alpha) { return std::sqrt(mu * (1 + alpha) / (mu + alpha)); }
    static float mu_at(float total_position, float alpha) {
        const float p = total_position * total_position;
        return p * alpha / (1 + alpha - p);
    }

    /// Of the row at `position` in [0, 1].
    static float alpha_at(float position) {
        const float least = std::sqrt(kSmoothAlpha), roughness = glm::mix(least, 1.0f, position * position);
        return roughness * roughness;
    }
    static float row_position(float alpha) {
        const float least = std::sqrt(kSmoothAlpha);
        return std::sqrt(clamp_unit((std::sqrt(alpha) - least) * (1 / (1 - least))));
    }

    Tables() {
        for (int j = 0; j < kSide; ++j) {
            const float alpha = alpha_at(static_cast<float>(j) / (kSide - 1));
            for (int i = 0; i < kSide; ++i) {
                const float x = static_cast<float>(i) / (kSide - 1);
                total[j][i] = integrate(std::min(mu_at(x, alpha), 1.0f), alpha).total;
                const GgxAlbedo albedo = integrate(x * x, alpha);
                ratio[j][i] = albedo.grazing / albedo.total;
            }
        }
        for (int j = 0; j < kSide; ++j) {
            const float alpha = alpha_at(static_cast<float>(j) / (kSide - 1));
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
        const float scaled = row_position(alpha) * (kSide - 1);
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
    const float position = Tables::row_position(alpha);
    return {interpolate(tables().average_total, position), interpolate(tables().average_grazing, position)};
}

}  // namespace rayuela
