// Writes the values of GgxTables as an initialiser: make_ggx_tables FILE.
#include "core/materials/fresnel.h"
#include "core/materials/ggx_albedo.h"
#include "core/materials/ggx_tables.h"

#include <cstdio>
#include <fstream>
#include <string>

namespace rayuela {
namespace {

/// Midpoints over the visible normals: half a turn, since the other half mirrors it, and strata of the spherical cap that
/// are narrower the closer to the horizon light leaves. Within 0.0002.
GgxAlbedo integrate(float mu, float alpha) {
    constexpr int kTurns = 48, kStrata = 128;
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

/// Raises a table over `integral(x, row)` until its interpolation does not fall below it: no surface may give back more than
/// it loses.
template <typename Integral>
void fill_from_above(GgxTables::Table& table, const Integral& integral) {
    constexpr int kCells = GgxTables::kSide - 1;
    constexpr float kMargin = 2e-5f;  // what the middle of a cell may not show
    GgxTables::Table exact;
    for (int j = 0; j <= kCells; ++j) {
        for (int i = 0; i <= kCells; ++i) exact[j][i] = integral(GgxTables::coordinate(i), GgxTables::coordinate(j));
    }
    table = exact;
    for (int j = 0; j < kCells; ++j) {
        for (int i = 0; i < kCells; ++i) {
            const float x = (static_cast<float>(i) + 0.5f) / kCells, row = (static_cast<float>(j) + 0.5f) / kCells;
            const float missing = integral(x, row) - interpolate(exact, x, row) + kMargin;
            for (const int b : {j, j + 1}) {
                for (const int a : {i, i + 1}) table[b][a] = std::clamp(exact[b][a] + missing, table[b][a], 1.0f);
            }
        }
    }
}

GgxTables make_tables() {
    GgxTables tables;
    fill_from_above(tables.total, [](float x, float row) {
        const float alpha = GgxTables::alpha_at_row(row);
        return integrate(GgxTables::mu_at_total(x, alpha), alpha).total;
    });
    fill_from_above(tables.ratio, [](float x, float row) {
        const GgxAlbedo albedo = integrate(GgxTables::mu_at_ratio(x), GgxTables::alpha_at_row(row));
        return albedo.grazing / albedo.total;
    });
    for (int j = 0; j < GgxTables::kSide; ++j) {
        const float alpha = GgxTables::alpha_at_row(GgxTables::coordinate(j));
        // Of what is interpolated, so that what is lost and what is given back are the same; and never rounded up, since
        // nearly smooth surfaces divide by the rest.
        constexpr int kSamples = 4096;
        constexpr double kRounding = 0x1p-22;
        double total = 0, grazing = 0;
        for (int i = 0; i < kSamples; ++i) {
            // mu dmu = d(mu^2) / 2: uniform in mu^2.
            const float mu = std::sqrt((static_cast<float>(i) + 0.5f) / kSamples);
            const float albedo = interpolate(tables.total[j], GgxTables::total_position(mu, alpha));
            total += albedo;
            grazing += albedo * interpolate(tables.ratio[j], GgxTables::ratio_position(mu));
        }
        tables.average_total[j] = static_cast<float>(total / kSamples - kRounding);
        tables.average_grazing[j] = static_cast<float>(grazing / kSamples);
    }
    return tables;
}

std::string text(float value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.9gF,", static_cast<double>(value));
    std::string number = buffer;
    if (number.find_first_of(".e") == std::string::npos) number.insert(number.size() - 2, ".");
    return number;
}
template <typename T>
std::string text(const T& values) {
    std::string list = "{{";
    for (const auto& value : values) list += text(value);
    return list + "}},\n";
}

}  // namespace
}  // namespace rayuela

int main(int count, char** arguments) {
    using namespace rayuela;
    if (count != 2) return 2;
    const GgxTables tables = make_tables();
    std::ofstream file(arguments[1]);
    file << text(tables.total) << text(tables.ratio) << text(tables.average_total) << text(tables.average_grazing);
    return file.flush() ? 0 : 1;
}
