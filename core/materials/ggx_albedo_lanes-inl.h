// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_GGX_ALBEDO_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_GGX_ALBEDO_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_GGX_ALBEDO_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_GGX_ALBEDO_LANES_INL_H_
#endif

#include "core/materials/ggx_tables.h"

#include "core/materials/microfacet_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"

// ggx_albedo.h, one surface a lane: the same operations in the same order, and so the same bits. None is smooth.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Between which two nodes of a table a lane interpolates, and where.
struct TablePosition {
    alignas(64) std::int32_t node[kLanes];
    Floats fraction;

    /// At `x` in [0, 1].
    explicit HWY_INLINE TablePosition(Floats x) {
        const hn::RebindToSigned<FloatTag> di;
        const Floats scaled = x * all_lanes(GgxTables::kSide - 1);
        const auto below = hn::Min(hn::Max(hn::ConvertTo(di, scaled), hn::Zero(di)), hn::Set(di, GgxTables::kSide - 2));
        hn::Store(below, di, node);
        fraction = scaled - hn::ConvertTo(FloatTag(), below);
    }
    HWY_INLINE Floats between(Floats a, Floats b) const { return mix(a, b, fraction); }
};

HWY_INLINE Floats interpolate(const GgxTables::Table& table, const TablePosition& x, const TablePosition& y) {
    // Of four neighbours in a row the first two count. The last of them may lie beyond the table, in what follows it.
    const auto in_row = [&](int above) HWY_ATTR {
        const FourLanes nodes = load_fours([&](std::size_t lane) HWY_ATTR {
            return table.front().data() + (y.node[lane] + above) * GgxTables::kSide + x.node[lane];
        });
        return x.between(nodes.x, nodes.y);
    };
    const Floats below = in_row(0), above = in_row(1);
    return y.between(below, above);
}

struct GgxAlbedoLanes {
    Floats total, grazing;

    HWY_INLINE Floats with_facets(Floats f0) const { return f0 * (total - grazing) + grazing; }
    HWY_INLINE Vec3Lanes with_facets(const Vec3Lanes& f0) const {
        return {with_facets(f0.x), with_facets(f0.y), with_facets(f0.z)};
    }
};

/// What ggx_albedo looks up for surfaces of this alpha.
class GgxAlbedoRow {
public:
    explicit HWY_INLINE GgxAlbedoRow(Floats alpha) : alpha_(alpha), row_(row_position(alpha)) {}

    HWY_INLINE Floats total(Floats mu) const {
        const Floats clamped = clamp_unit(mu), one = all_lanes(1.0f);
        const TablePosition x(hn::Sqrt(clamped * (one + alpha_) / (clamped + alpha_)));
        return interpolate(ggx_tables().total, x, row_);
    }
    HWY_INLINE GgxAlbedoLanes at(Floats mu) const {
        const Floats all = total(mu);
        const TablePosition x(hn::Sqrt(clamp_unit(mu)));
        return {all, all * interpolate(ggx_tables().ratio, x, row_)};
    }

private:
    static HWY_INLINE Floats row_position(Floats alpha) {
        const float least = std::sqrt(kSmoothAlpha);
        return hn::Sqrt(clamp_unit((hn::Sqrt(alpha) - all_lanes(least)) * all_lanes(1 / (1 - least))));
    }

    Floats alpha_;
    TablePosition row_;
};

HWY_INLINE Floats energy_lobe(Floats albedo_o, Floats albedo_i, Floats average) {
    const Floats one = all_lanes(1.0f);
    return hn::IfThenElseZero(hn::Lt(average, one), (one - albedo_o) * (one - albedo_i) / (one - average));
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
