#include "core/accel/kd_cut.h"

#include "core/math/float_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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
/// Of larger nodes every so many-th reference is counted that at least so many are: planes are as good.
constexpr std::size_t kCounted = 1 << 13;
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
    /// `weight`: references that each of those stands for which are counted.
    CutSearch(const Bounds3& cell, std::size_t counted, double weight, float step_cost)
        : cell_(cell),
          extent_(Vec3d(cell.hi) - Vec3d(cell.lo)),
          counted_(counted),
          weight_(weight),
          step_cost_(step_cost) {
        const Vec3d& e = extent_;
        has_area_ = e.x * e.y + e.y * e.z + e.z * e.x > 0;
    }

    HWY_INLINE void consider(int axis, Planes& planes) {
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        const hn::Rebind<std::int32_t, DoubleTag> di;
        // What lies on a side of the cell is no cut.
        std::fill_n(planes.plane + planes.size, kDoubles, cell_.lo[axis]);
        const Doubles lo = hn::Set(dd, cell_.lo[axis]), hi = hn::Set(dd, cell_.hi[axis]);
        const Slope slope = slope_of(axis);
        const Doubles a = hn::Set(dd, slope.per_depth), b = hn::Set(dd, slope.at_none), zero = hn::Zero(dd);
        const Doubles extent = hn::Set(dd, extent_[axis]), per_whole = hn::Set(dd, weight_ / slope_of(0).of(extent_.x));
        for (std::size_t i = 0; i < planes.size; i += kDoubles) {
            const Doubles plane = hn::PromoteTo(dd, hn::Load(df, planes.plane + i)), depth = plane - lo;
            const Doubles below = hn::PromoteTo(dd, hn::Load(di, planes.below + i)),
                          above = hn::PromoteTo(dd, hn::Load(di, planes.above + i));
            const Doubles tests = (a * depth + b) * below + (a * (extent - depth) + b) * above;
            const auto cuts_off_space = hn::Or(hn::Eq(below, zero), hn::Eq(above, zero));
            const Doubles bonus = hn::IfThenElse(cuts_off_space, hn::Set(dd, kEmptyBonus), hn::Set(dd, 1));
            const Doubles cost = bonus * (hn::Set(dd, step_cost_) + tests * per_whole);
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
        const auto duplicates = static_cast<std::size_t>(weight_ * static_cast<double>(both - counted_));
        best_ = {.axis = axis, .plane = planes.plane[i], .cost = cost, .duplicates = duplicates};
    }

    Bounds3 cell_;
    Vec3d extent_;
    bool has_area_;
    std::size_t counted_;
    double weight_, step_cost_, best_cost_ = INFINITY;
    KdCut best_;
};

using Counts = hn::Vec<hn::RebindToSigned<FloatTag>>;

/// One more in the lanes of the mask.
HWY_INLINE Counts count_up(Counts counts, FloatMask where) {
    const hn::RebindToSigned<FloatTag> di;
#if HWY_TARGET <= HWY_AVX3
    return hn::IfThenElse(hn::RebindMask(di, where), hn::Add(counts, hn::Set(di, 1)), counts);
#else
    // A mask's lanes are 0 or -1.
    return hn::Sub(counts, hn::VecFromMask(di, hn::RebindMask(di, where)));
#endif
}

/// Every plane at which a box begins or ends. A flat box within the plane is below it.
HWY_INLINE std::optional<KdCut> search_exact(std::span<const KdReference> references, const Bounds3& cell,
                                             float step_cost) {
    CutSearch search(cell, references.size(), 1, step_cost);
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const std::size_t n = references.size();
    Planes planes;
    planes.size = 2 * n;
    alignas(64) float begins[kExactLimit];
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < n; ++i) {
            const float lo = references[i].box.lo[axis], hi = references[i].box.hi[axis];
            planes.plane[i] = lo;
            planes.plane[n + i] = hi;
            // So that a flat box begins before the plane in which it lies.
            begins[i] = lo < hi ? lo : next_down(lo);
        }
        for (std::size_t i = 0; i < planes.size; i += kLanes) {
            const Floats plane = hn::LoadU(d, planes.plane + i);
            auto below = hn::Zero(di), above = below;
            for (std::size_t k = 0; k < n; ++k) {
                const FloatMask is_below = hn::Lt(hn::Set(d, begins[k]), plane);
                const FloatMask is_above = hn::Gt(hn::Set(d, planes.plane[n + k]), plane);
                below = count_up(below, is_below);
                above = count_up(above, is_above);
            }
            hn::StoreU(below, di, planes.below + i);
            hn::StoreU(above, di, planes.above + i);
        }
        search.consider(axis, planes);
    }
    return search.best();
}

/// Coordinates of a box: lo.x lo.y lo.z hi.x, or lo.z hi.x hi.y hi.z, so that no vector reaches beyond it.
using CoordinateTag = hn::CappedTag<float, 4>;
using Coordinates = float[4];
constexpr std::size_t kLow = 0, kHigh = 2;

/// How many boxes begin and end in each of the bins along each axis.
class Bins {
public:
    Bins(const Bounds3& held, const Vec3& per_unit) {
        for (int axis = 0; axis < 3; ++axis) {
            origin_low_[axis] = origin_high_[axis + 1] = held.lo[axis];
            scale_low_[axis] = scale_high_[axis + 1] = per_unit[axis];
        }
    }

    HWY_INLINE void count(std::span<const KdReference> references, std::size_t stride) {
        const CoordinateTag d;
        const hn::RebindToSigned<CoordinateTag> di;
        alignas(16) std::int32_t begin[4], end[4];
        std::size_t set = 0;
        for (std::size_t k = 0; k < references.size(); k += stride) {
            const float* const box = &references[k].box.lo.x;
            for (std::size_t i = 0; i < 4; i += hn::MaxLanes(d)) {
                hn::Store(hn::ConvertTo(di, depth(box + kLow, origin_low_, scale_low_, i)), di, begin + i);
                // A box that ends at a plane is not above it: its end is in the bin before.
                const auto at = depth(box + kHigh, origin_high_, scale_high_, i);
                const auto whole = hn::ConvertTo(di, at);
                const auto at_plane = hn::VecFromMask(di, hn::RebindMask(di, hn::Eq(hn::ConvertTo(d, whole), at)));
                hn::Store(hn::Max(hn::Add(whole, at_plane), hn::Zero(di)), di, end + i);
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::int32_t last = end[axis + 1];
                ++begins_[set][axis][static_cast<std::size_t>(std::min(begin[axis], last))];
                ++ends_[set][axis][static_cast<std::size_t>(last)];
            }
            set = 1 - set;
        }
    }

    std::int32_t begins(std::size_t axis, std::size_t bin) const {
        return begins_[0][axis][bin] + begins_[1][axis][bin];
    }
    std::int32_t ends(std::size_t axis, std::size_t bin) const { return ends_[0][axis][bin] + ends_[1][axis][bin]; }

private:
    static HWY_INLINE hn::Vec<CoordinateTag> depth(const float* box, const Coordinates& origin,
                                                   const Coordinates& scale, std::size_t i) {
        const CoordinateTag d;
        const auto bins = hn::Mul(hn::Sub(hn::LoadU(d, box + i), hn::Load(d, origin + i)), hn::Load(d, scale + i));
        return hn::Min(bins, hn::Set(d, float{kBins}));
    }

    /// Two sets take turns: neighbours fall into the same bins, and to count up what was just counted up waits.
    std::array<std::array<std::array<std::int32_t, kBins>, 3>, 2> begins_{}, ends_{};
    alignas(16) Coordinates origin_low_{}, scale_low_{}, origin_high_{}, scale_high_{};
};

HWY_INLINE Bounds3 bounds_of(std::span<const KdReference> references) {
    const CoordinateTag d;
    alignas(16) Coordinates lo, hi;
    for (std::size_t i = 0; i < 4; i += hn::MaxLanes(d)) {
        auto least = hn::Set(d, INFINITY), most = hn::Set(d, -INFINITY);
        for (const KdReference& reference : references) {
            const float* const box = &reference.box.lo.x;
            least = hn::Min(least, hn::LoadU(d, box + kLow + i));
            most = hn::Max(most, hn::LoadU(d, box + kHigh + i));
        }
        hn::Store(least, d, lo + i);
        hn::Store(most, d, hi + i);
    }
    return {{lo[0], lo[1], lo[2]}, {hi[1], hi[2], hi[3]}};
}

/// Planes at equal distances over what the node holds, so that the outermost cut off empty space.
HWY_INLINE std::optional<KdCut> search_binned(std::span<const KdReference> references, const Bounds3& cell,
                                              float step_cost) {
    const std::size_t stride = std::max<std::size_t>(1, references.size() / kCounted);
    const std::size_t counted = (references.size() + stride - 1) / stride;
    CutSearch search(cell, counted, static_cast<double>(references.size()) / static_cast<double>(counted), step_cost);
    const Bounds3 held = bounds_of(references);
    const Vec3 per_unit = float{kBins} / (held.hi - held.lo);
    Bins bins(held, per_unit);
    bins.count(references, stride);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        // Axes too flat or too long to be divided in float are left alone.
        if (!(per_unit[a] > 0 && per_unit[a] < INFINITY)) continue;
        Planes planes;
        planes.size = kBins + 1;
        planes.below[0] = 0;
        planes.above[0] = static_cast<std::int32_t>(counted);
        for (std::size_t k = 0; k < kBins; ++k) planes.plane[k] = held.lo[a] + static_cast<float>(k) / per_unit[a];
        planes.plane[kBins] = held.hi[a];
        for (std::size_t k = 0; k < kBins; ++k) {
            planes.below[k + 1] = planes.below[k] + bins.begins(axis, k);
            planes.above[k + 1] = planes.above[k] - bins.ends(axis, k);
        }
        // Between the outermost planes something lies on both sides, be it among what is not counted.
        for (std::size_t k = 1; k < kBins && stride > 1; ++k) {
            planes.below[k] = std::max(1, planes.below[k]);
            planes.above[k] = std::max(1, planes.above[k]);
        }
        search.consider(a, planes);
    }
    return search.best();
}

HWY_ATTR std::optional<KdCut> find_cut(std::span<const KdReference> references, const Bounds3& cell, float step_cost) {
    return references.size() <= kExactLimit ? search_exact(references, cell, step_cost)
                                            : search_binned(references, cell, step_cost);
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
