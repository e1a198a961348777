#include "core/accel/kd_cut.h"

#include <algorithm>
#include <array>
#include <cmath>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/sah_cut.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/lane_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr int kBins = 32;
constexpr std::size_t kExactLimit = 32;
constexpr double kEmptyBonus = 0.8;

/// Planes across one axis, and how many references lie below and above each. Room for whole vectors.
struct Planes {
    static constexpr std::size_t kRoom = 2 * kExactLimit + 16;
    alignas(64) float plane[kRoom];
    alignas(64) std::int32_t below[kRoom], above[kRoom];
    std::size_t size = 0;
};

/// Keeps the cheapest of the planes offered to it.
class CutSearch {
public:
    CutSearch(const Bounds3& cell, std::size_t references, float step_cost)
        : cell_(cell), extent_(Vec3d(cell.hi) - Vec3d(cell.lo)), references_(references), step_cost_(step_cost) {
        const Vec3d& e = extent_;
        has_area_ = e.x * e.y + e.y * e.z + e.z * e.x > 0;
    }

    HWY_INLINE void consider(int axis, Planes& planes) {
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        const hn::Rebind<std::int32_t, DoubleTag> di;
        constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());
        // What lies on a side of the cell is no cut.
        std::fill_n(planes.plane + planes.size, kDoubles, cell_.lo[axis]);
        const Doubles lo = hn::Set(dd, cell_.lo[axis]), hi = hn::Set(dd, cell_.hi[axis]);
        const Slope slope = slope_of(axis);
        const Doubles a = hn::Set(dd, slope.per_depth), b = hn::Set(dd, slope.at_none), zero = hn::Zero(dd);
        const Doubles extent = hn::Set(dd, extent_[axis]), whole = hn::Set(dd, slope_of(0).of(extent_.x));
        for (std::size_t i = 0; i < planes.size; i += kDoubles) {
            const Doubles plane = hn::PromoteTo(dd, hn::Load(df, planes.plane + i)), depth = plane - lo;
            const Doubles below = hn::PromoteTo(dd, hn::Load(di, planes.below + i)),
                          above = hn::PromoteTo(dd, hn::Load(di, planes.above + i));
            const Doubles tests = (a * depth + b) * below + (a * (extent - depth) + b) * above;
            const auto cuts_off_space = hn::Or(hn::Eq(below, zero), hn::Eq(above, zero));
            const Doubles bonus = hn::IfThenElse(cuts_off_space, hn::Set(dd, kEmptyBonus), hn::Set(dd, 1));
            const Doubles cost = bonus * (hn::Set(dd, step_cost_) + tests / whole);
            const auto inside = hn::And(hn::Gt(plane, lo), hn::Lt(plane, hi));
            LaneBits better = bits_of(dd, hn::And(inside, hn::Lt(cost, hn::Set(dd, best_cost_))));
            if (better == 0) continue;
            alignas(64) double costs[kDoubles];
            hn::Store(cost, dd, costs);
            for (; better != 0; better &= better - 1) {
                const std::size_t k = first_lane(better);
                if (costs[k] < best_cost_) take(axis, planes, i + k, costs[k]);
            }
        }
    }

    std::optional<KdCut> best() const { return best_cost_ < INFINITY ? std::optional(best_) : std::nullopt; }

private:
    /// Half the surface area of a part of the cell, or its length where the cell has no area, by its depth along an axis.
    struct Slope {
        double per_depth, at_none;
        double of(double depth) const { return per_depth * depth + at_none; }
    };
    Slope slope_of(int axis) const {
        const double u = extent_[(axis + 1) % 3], v = extent_[(axis + 2) % 3];
        return has_area_ ? Slope{u + v, u * v} : Slope{1, u + v};
    }

    void take(int axis, const Planes& planes, std::size_t i, double cost) {
        best_cost_ = cost;
        const auto both = static_cast<std::size_t>(planes.below[i] + planes.above[i]);
        best_ = {.axis = axis, .plane = planes.plane[i], .cost = cost, .duplicates = both - references_};
    }

    Bounds3 cell_;
    Vec3d extent_;
    bool has_area_;
    std::size_t references_;
    double step_cost_, best_cost_ = INFINITY;
    KdCut best_;
};

/// Every plane at which a box begins or ends. A flat box within the plane is below it.
HWY_INLINE void search_exact(std::span<const KdReference> references, CutSearch& search) {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const std::size_t n = references.size();
    Planes planes;
    planes.size = 2 * n;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < n; ++i) {
            planes.plane[i] = references[i].box.lo[axis];
            planes.plane[n + i] = references[i].box.hi[axis];
        }
        for (std::size_t i = 0; i < planes.size; i += kLanes) {
            const Floats plane = hn::LoadU(d, planes.plane + i);
            auto below = hn::Zero(di), above = below;
            for (std::size_t k = 0; k < n; ++k) {
                const FloatMask is_above = hn::Gt(hn::Set(d, planes.plane[n + k]), plane);
                const FloatMask begins = hn::Lt(hn::Set(d, planes.plane[k]), plane);
                // A mask's lanes are 0 or -1.
                above = hn::Sub(above, hn::VecFromMask(di, hn::RebindMask(di, is_above)));
                below = hn::Sub(below, hn::VecFromMask(di, hn::RebindMask(di, hn::Or(begins, hn::Not(is_above)))));
            }
            hn::StoreU(below, di, planes.below + i);
            hn::StoreU(above, di, planes.above + i);
        }
        search.consider(axis, planes);
    }
}

/// Planes at equal distances over what the node holds, so that the outermost cut off empty space.
HWY_INLINE void search_binned(std::span<const KdReference> references, CutSearch& search) {
    Bounds3 held;
    for (const KdReference& reference : references) held.extend(reference.box);
    const Vec3 per_unit = float{kBins} / (held.hi - held.lo);
    std::array<std::array<std::int32_t, kBins>, 3> begins{}, ends{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        // Axes too flat or too long to be divided in float are left alone.
        if (!(per_unit[a] > 0 && per_unit[a] < INFINITY)) continue;
        const float origin = held.lo[a], scale = per_unit[a];
        for (const KdReference& reference : references) {
            // A box that ends at a plane is not above it; a flat one within the plane is below it.
            const float to = std::min((reference.box.hi[a] - origin) * scale, float{kBins});
            const int last = static_cast<int>(to);
            const int end = std::max(last - (static_cast<float>(last) == to ? 1 : 0), 0);
            const int begin = std::min(static_cast<int>((reference.box.lo[a] - origin) * scale), end);
            ++begins[axis][static_cast<std::size_t>(begin)];
            ++ends[axis][static_cast<std::size_t>(end)];
        }
        Planes planes;
        planes.size = kBins + 1;
        planes.below[0] = 0;
        planes.above[0] = static_cast<std::int32_t>(references.size());
        for (std::size_t k = 0; k < kBins; ++k) {
            planes.plane[k] = origin + static_cast<float>(k) / scale;
            planes.below[k + 1] = planes.below[k] + begins[axis][k];
            planes.above[k + 1] = planes.above[k] - ends[axis][k];
        }
        planes.plane[kBins] = held.hi[a];
        search.consider(a, planes);
    }
}

HWY_ATTR std::optional<KdCut> find_cut(std::span<const KdReference> references, const Bounds3& cell, float step_cost) {
    CutSearch search(cell, references.size(), step_cost);
    if (references.size() <= kExactLimit) {
        search_exact(references, search);
    } else {
        search_binned(references, search);
    }
    return search.best();
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(find_cut);

std::optional<KdCut> find_sah_cut(std::span<const KdReference> references, const Bounds3& cell, float step_cost) {
    return HWY_DYNAMIC_DISPATCH(find_cut)(references, cell, step_cost);
}

}  // namespace rayuela
#endif
