#include "core/materials/ggx_albedo.h"

#include "core/materials/fresnel.h"
#include "core/materials/ggx_tables.h"
#include "core/materials/microfacet.h"

namespace rayuela {
namespace {

constexpr GgxTables kTables{
#include "ggx_tables.inc"  // written by make_ggx_tables
};

}  // namespace

const GgxTables& ggx_tables() {
    return kTables;
}

GgxAlbedo ggx_albedo(float mu, float alpha) {
    mu = clamp_unit(mu);
    if (alpha < kSmoothAlpha) return {1, schlick_weight(mu)};
    const float row = GgxTables::row_position(alpha);
    const float total = interpolate(kTables.total, GgxTables::total_position(mu, alpha), row);
    return {total, total * interpolate(kTables.ratio, GgxTables::ratio_position(mu), row)};
}

GgxAlbedo ggx_average_albedo(float alpha) {
    if (alpha < kSmoothAlpha) return {1, 1.0f / 21};
    const float row = GgxTables::row_position(alpha);
    return {interpolate(kTables.average_total, row), interpolate(kTables.average_grazing, row)};
}

}  // namespace rayuela
