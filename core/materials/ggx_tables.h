#pragma once

#include "core/materials/microfacet.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

/// What ggx_albedo interpolates. A row for each roughness = sqrt(alpha), from the least that is not smooth, closest together
/// there. The loss of energy depends on mu / alpha near the horizon and on mu elsewhere, Fresnel's effect on mu: so each has
/// its own coordinate. Computed when the program is built (make_ggx_tables.cpp).
struct GgxTables {
    static constexpr int kSide = 64;
    using Row = std::array<float, kSide>;
    using Table = std::array<Row, kSide>;

    Table total;                         ///< GgxAlbedo::total over total_position(mu).
    Table ratio;                         ///< grazing / total over ratio_position(mu).
    Row average_total, average_grazing;  ///< Over the hemisphere, weighted by the cosine.

    /// Of a node.
    static float coordinate(int i) { return static_cast<float>(i) / (kSide - 1); }

    static float total_position(float mu, float alpha) { return std::sqrt(mu * (1 + alpha) / (mu + alpha)); }
    static float mu_at_total(float position, float alpha) {
        const float p = position * position;
        return std::min(p * alpha / (1 + alpha - p), 1.0f);
    }
    static float ratio_position(float mu) { return std::sqrt(mu); }
    static float mu_at_ratio(float position) { return position * position; }

    static float row_position(float alpha) {
        const float least = std::sqrt(kSmoothAlpha);
        return std::sqrt(clamp_unit((std::sqrt(alpha) - least) * (1 / (1 - least))));
    }
    static float alpha_at_row(float position) {
        const float least = std::sqrt(kSmoothAlpha), roughness = glm::mix(least, 1.0f, position * position);
        return roughness * roughness;
    }
};

const GgxTables& ggx_tables();

/// Linear interpolation at `x` in [0, 1].
inline float interpolate(const GgxTables::Row& row, float x) {
    const float scaled = x * (GgxTables::kSide - 1);
    const int i = std::clamp(static_cast<int>(scaled), 0, GgxTables::kSide - 2);
    return glm::mix(row[i], row[i + 1], scaled - static_cast<float>(i));
}

/// The same in both directions; `y` chooses the row.
inline float interpolate(const GgxTables::Table& table, float x, float y) {
    const float scaled = y * (GgxTables::kSide - 1);
    const int j = std::clamp(static_cast<int>(scaled), 0, GgxTables::kSide - 2);
    return glm::mix(interpolate(table[j], x), interpolate(table[j + 1], x), scaled - static_cast<float>(j));
}

}  // namespace rayuela
