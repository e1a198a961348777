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

/// The cheapest of the planes offered to it; of several the one with the least number.
class CutSearch {
public:
    /// What the cell is across the axis of each lane.
    struct Across {
        Doubles lo, hi, extent;
        Doubles per_depth, at_none;  ///< Half the surface area of a part of the cell by its depth.
    };

    /// `weight`: references that each of those stands for which are counted.
    CutSearch(const Bounds3& cell, double weight, float step_cost)
        : cell_(cell), extent_(Vec3d(cell.hi) - Vec3d(cell.lo)), step_cost_(step_cost) {
        const Vec3d& e = extent_;
        has_area_ = e.x * e.y + e.y * e.z + e.z * e.x > 0;
        per_whole_ = weight / slope_of(0).of(e.x);
    }

    /// The same axis in all lanes.
    HWY_INLINE Across across(int axis) const {
        const DoubleTag dd;
        const Slope slope = slope_of(axis);
        return {hn::Set(dd, cell_.lo[axis]), hn::Set(dd, cell_.hi[axis]), hn::Set(dd, extent_[axis]),
                hn::Set(dd, slope.per_depth), hn::Set(dd, slope.at_none)};
    }
    /// x, y, z, none and so on from the axis `first`; where there is none no cut is.
    HWY_INLINE Across across_in_turn(std::size_t first) const {
        alignas(64) double rows[5][8] = {};
        for (int axis = 0; axis < 3; ++axis) {
            const Slope slope = slope_of(axis);
            const double of_axis[5] = {cell_.lo[axis], cell_.hi[axis], extent_[axis], slope.per_depth, slope.at_none};
            for (std::size_t i = 0; i < 5; ++i) rows[i][axis] = rows[i][axis + 4] = of_axis[i];
        }
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(DoubleTag(), rows[i] + first); };
        return {row(0), row(1), row(2), row(3), row(4)};
    }

    HWY_INLINE void consider(const Across& cell, const float* planes, const std::int32_t* counts_below,
                             const std::int32_t* counts_above, Doubles number) {
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        const hn::Rebind<std::int32_t, DoubleTag> di;
        const Doubles plane = hn::PromoteTo(dd, hn::Load(df, planes)), depth = plane - cell.lo, zero = hn::Zero(dd);
        const Doubles below = hn::PromoteTo(dd, hn::Load(di, counts_below)),
                      above = hn::PromoteTo(dd, hn::Load(di, counts_above));
        const Doubles tests = (cell.per_depth * depth + cell.at_none) * below +
                              (cell.per_depth * (cell.extent - depth) + cell.at_none) * above;
        const auto cuts_off_space = hn::Or(hn::Eq(below, zero), hn::Eq(above, zero));
        const Doubles bonus = hn::IfThenElse(cuts_off_space, hn::Set(dd, kEmptyBonus), hn::Set(dd, 1));
        const Doubles cost = bonus * (hn::Set(dd, step_cost_) + tests * hn::Set(dd, per_whole_));
        // What lies on a side of the cell is no cut.
        const auto inside = hn::And(hn::Gt(plane, cell.lo), hn::Lt(plane, cell.hi));
        const auto better = hn::And(inside, hn::Lt(cost, best_cost_));
        best_cost_ = hn::IfThenElse(better, cost, best_cost_);
        best_number_ = hn::IfThenElse(better, number, best_number_);
    }

    struct Best {
        double cost;  ///< Infinite where there is none.
        std::size_t number;
    };
    HWY_INLINE Best best() const {
        const DoubleTag dd;
        const Doubles cost = hn::MinOfLanes(dd, best_cost_);
        const Doubles numbers = hn::IfThenElse(hn::Eq(best_cost_, cost), best_number_, hn::Set(dd, INFINITY));
        return {hn::GetLane(cost), static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(dd, numbers)))};
    }

private:
    /// Half the surface area of a part of the cell, or its length where the cell has no area, by its depth along an axis.
    struct Slope {
        double per_depth = 0, at_none = 0;
        double of(double depth) const { return per_depth * depth + at_none; }
    };
    Slope slope_of(int axis) const {
        const double u = extent_[(axis + 1) % 3], v = extent_[(axis + 2) % 3];
        return has_area_ ? Slope{u + v, u * v} : Slope{1, u + v};
    }

    Bounds3 cell_;
    Vec3d extent_;
    bool has_area_;
    double step_cost_, per_whole_;
    /// In each lane, of the planes that came there.
    Doubles best_cost_ = hn::Set(DoubleTag(), INFINITY), best_number_ = hn::Zero(DoubleTag());
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

/// The four numbers from `from` on, in turn, the first of them in the lane that has the i-th of all planes.
HWY_INLINE Floats load_axes(const float* from, std::size_t i) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(FloatTag(), from[i % 4]);
#else
    (void)i;
    return hn::LoadDup128(FloatTag(), from);
#endif
}

/// Every plane at which a box begins or ends. A flat box within the plane is below it.
HWY_INLINE std::optional<KdCut> search_exact(std::span<const KdReference> references, const Bounds3& cell,
                                             float step_cost) {
    // Rows of 8: where a box begins along x, y and z, nothing, and where it ends.
    constexpr std::size_t kRow = 8, kEnd = 4, kRoom = kExactLimit * kRow + kLanes;
    alignas(64) float planes[kRoom], begins[kExactLimit * kEnd];
    alignas(64) std::int32_t below[kRoom], above[kRoom];
    const std::size_t n = references.size();
    for (std::size_t k = 0; k < n; ++k) {
        const float *const lo = &references[k].box.lo.x, *const hi = &references[k].box.hi.x;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            planes[kRow * k + axis] = lo[axis];
            planes[kRow * k + kEnd + axis] = hi[axis];
            // So that a flat box begins before the plane in which it lies.
            begins[kEnd * k + axis] = lo[axis] < hi[axis] ? lo[axis] : next_down(lo[axis]);
        }
        planes[kRow * k + 3] = planes[kRow * k + 7] = begins[kEnd * k + 3] = 0;
    }
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    for (std::size_t i = 0; i < n * kRow; i += kLanes) {
        const Floats plane = hn::Load(d, planes + i);
        auto is_below = hn::Zero(di), is_above = is_below;
        for (std::size_t k = 0; k < n; ++k) {
            is_below = count_up(is_below, hn::Lt(load_axes(begins + kEnd * k, i), plane));
            is_above = count_up(is_above, hn::Gt(load_axes(planes + kRow * k + kEnd, i), plane));
        }
        hn::Store(is_below, di, below + i);
        hn::Store(is_above, di, above + i);
    }
    CutSearch search(cell, 1, step_cost);
    const DoubleTag dd;
    for (std::size_t lane = 0; lane < kRow; lane += kDoubles) {
        const CutSearch::Across across = search.across_in_turn(lane);
        alignas(64) double numbers[kDoubles];
        for (std::size_t k = 0; k < kDoubles; ++k)
            numbers[k] = static_cast<double>((lane + k) % kEnd * 2 * kExactLimit + (lane + k) / kEnd * kExactLimit);
        Doubles number = hn::Load(dd, numbers);
        for (std::size_t i = lane; i < n * kRow; i += kRow) {
            search.consider(across, planes + i, below + i, above + i, number);
            number = number + hn::Set(dd, 1);
        }
    }
    const CutSearch::Best best = search.best();
    if (best.cost == INFINITY) return {};
    const std::size_t axis = best.number / (2 * kExactLimit), end = best.number / kExactLimit % 2;
    const std::size_t at = best.number % kExactLimit * kRow + end * kEnd + axis;
    return KdCut{.axis = static_cast<int>(axis),
                 .plane = planes[at],
                 .cost = best.cost,
                 .duplicates = static_cast<std::size_t>(below[at] + above[at]) - n};
}

/// Coordinates of a box: lo.x lo.y lo.z hi.x hi.y hi.z, and two words more of the reference in whole vectors.
using BoxTag = hn::CappedTag<float, 8>;
using Boxes = hn::Vec<BoxTag>;
constexpr std::size_t kSides = 6, kBoxLanes = hn::MaxLanes(BoxTag());
using BoxRow = float[8];
static_assert(sizeof(KdReference) == sizeof(BoxRow));

/// A vector of bytes, as many of which as are needed hold a count for each bin.
using ByteTag = hn::CappedTag<std::uint8_t, kBins>;
constexpr std::size_t kBytes = hn::MaxLanes(ByteTag());

/// kSteps + kBins - b: for each bin whether it is b or lies beyond.
alignas(64) constexpr auto kSteps = [] {
    std::array<std::uint8_t, 2 * kBins> steps{};
    for (std::size_t i = kBins; i < steps.size(); ++i) steps[i] = 1;
    return steps;
}();

/// How many boxes begin, and how many end, in each bin along each axis or in one before.
class Bins {
public:
    Bins(const Bounds3& held, const Vec3& per_unit) {
        // Words that are no sides look like denormal numbers, which are slow to multiply.
        origin_[kSides] = origin_[kSides + 1] = 1;
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = origin_[3 + axis] = held.lo[axis];
            scale_[axis] = scale_[3 + axis] = per_unit[axis];
            at_end_[3 + axis] = 1;
        }
    }

    /// Of every stride-th reference.
    HWY_INLINE void count(std::span<const KdReference> references, std::size_t stride) {
        constexpr std::size_t kFitByte = 255;
        for (std::size_t k = 0; k < references.size(); k += kFitByte * stride) {
            const auto few = references.subspan(k, std::min(kFitByte * stride, references.size() - k));
            count_few(few, stride, k == 0);
        }
    }

    std::int32_t begun(std::size_t axis, std::size_t bin) const { return counts_[axis][bin]; }
    std::int32_t ended(std::size_t axis, std::size_t bin) const { return counts_[3 + axis][bin]; }

private:
    HWY_INLINE void count_few(std::span<const KdReference> references, std::size_t stride, bool first) {
        const ByteTag db;
        hn::Vec<ByteTag> counts[kSides][kBins / kBytes];
        for (auto& side : counts) {
            for (auto& part : side) part = hn::Zero(db);
        }
        const auto add = [&](std::size_t side, std::uint32_t bins_left) HWY_ATTR {
            const std::uint8_t* const step = kSteps.data() + bins_left;
            for (std::size_t i = 0; i < kBins / kBytes; ++i)
                counts[side][i] = hn::Add(counts[side][i], hn::LoadU(db, step + i * kBytes));
        };
        for (std::size_t k = 0; k < references.size(); k += stride) {
            alignas(32) std::uint32_t left[8];
            for (std::size_t i = 0; i < kSides; i += kBoxLanes) bins_left(&references[k].box.lo.x, i, left);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::uint32_t end = left[3 + axis] & kLeftMask;
                add(axis, std::max(left[axis] & kLeftMask, end));
                add(3 + axis, end);
            }
        }
        for (std::size_t side = 0; side < kSides; ++side) {
            alignas(32) std::uint8_t bytes[kBins];
            for (std::size_t i = 0; i < kBins / kBytes; ++i) hn::Store(counts[side][i], db, bytes + i * kBytes);
            auto& sum = counts_[side];
            for (std::size_t bin = 0; bin < kBins; ++bin) sum[bin] = first ? bytes[bin] : sum[bin] + bytes[bin];
        }
    }

    /// kBins less the bin of each side, in the last bits.
    HWY_INLINE void bins_left(const float* box, std::size_t i, std::uint32_t* left) const {
        const BoxTag d;
        const Boxes bins = hn::Mul(hn::Sub(hn::LoadU(d, box + i), hn::Load(d, origin_ + i)), hn::Load(d, scale_ + i));
        const Boxes at = hn::Min(bins, hn::Set(d, float{kBins})), whole = hn::Floor(at);
        // A box that ends at a plane is not above it: its end is in the bin before.
        const Boxes back = hn::IfThenElseZero(hn::Eq(whole, at), hn::Load(d, at_end_ + i));
        const Boxes bin = hn::Max(hn::Sub(whole, back), hn::Zero(d));
        hn::Store(hn::BitCast(hn::RebindToUnsigned<BoxTag>(), hn::Sub(hn::Set(d, kWhole + kBins), bin)),
                  hn::RebindToUnsigned<BoxTag>(), left + i);
    }

    /// A whole number that is added to this one stands in the last bits of the sum.
    static constexpr float kWhole = 0x1p23f;
    static constexpr std::uint32_t kLeftMask = 0xff;

    alignas(64) std::array<std::array<std::int32_t, kBins>, kSides> counts_;  ///< Beginnings of three axes, then ends.
    alignas(32) BoxRow origin_{}, scale_{}, at_end_{};
};

HWY_INLINE Bounds3 bounds_of(std::span<const KdReference> references) {
    const BoxTag d;
    alignas(32) BoxRow lo, hi;
    for (std::size_t i = 0; i < kSides; i += kBoxLanes) {
        Boxes least = hn::Set(d, INFINITY), most = hn::Set(d, -INFINITY);
        for (const KdReference& reference : references) {
            const Boxes box = hn::LoadU(d, &reference.box.lo.x + i);
            least = hn::Min(least, box);
            most = hn::Max(most, box);
        }
        hn::Store(least, d, lo + i);
        hn::Store(most, d, hi + i);
    }
    return {{lo[0], lo[1], lo[2]}, {hi[3], hi[4], hi[5]}};
}

/// Planes at equal distances over what the node holds, so that the outermost cut off empty space.
HWY_INLINE std::optional<KdCut> search_binned(std::span<const KdReference> references, const Bounds3& cell,
                                              float step_cost) {
    const std::size_t stride = std::max<std::size_t>(1, references.size() / kCounted);
    const std::size_t counted = (references.size() + stride - 1) / stride;
    const double weight = static_cast<double>(references.size()) / static_cast<double>(counted);
    const auto all = static_cast<std::int32_t>(counted);
    CutSearch search(cell, weight, step_cost);
    const Bounds3 held = bounds_of(references);
    const Vec3 per_unit = float{kBins} / (held.hi - held.lo);
    Bins bins(held, per_unit);
    bins.count(references, stride);
    // Room for whole vectors.
    constexpr std::size_t kRoom = kBins + 16;
    alignas(64) float planes[3][kRoom];
    alignas(64) std::int32_t below[3][kRoom], above[3][kRoom];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        // Axes too flat or too long to be divided in float are left alone.
        if (!(per_unit[a] > 0 && per_unit[a] < INFINITY)) continue;
        const FloatTag d;
        for (std::size_t k = 0; k < kBins; k += kLanes) {
            const Floats depth = hn::Div(hn::Iota(d, static_cast<float>(k)), hn::Set(d, per_unit[a]));
            hn::Store(hn::Add(hn::Set(d, held.lo[a]), depth), d, planes[axis] + k);
        }
        planes[axis][kBins] = held.hi[a];
        std::fill_n(planes[axis] + kBins + 1, kDoubles, cell.lo[a]);
        below[axis][0] = 0;
        above[axis][0] = all;
        for (std::size_t k = 0; k < kBins; ++k) {
            below[axis][k + 1] = bins.begun(axis, k);
            above[axis][k + 1] = all - bins.ended(axis, k);
        }
        // Between the outermost planes something lies on both sides, be it among what is not counted.
        for (std::size_t k = 1; k < kBins && stride > 1; ++k) {
            below[axis][k] = std::max(1, below[axis][k]);
            above[axis][k] = std::max(1, above[axis][k]);
        }
        const DoubleTag dd;
        const CutSearch::Across across = search.across(a);
        for (std::size_t k = 0; k <= kBins; k += kDoubles) {
            search.consider(across, planes[axis] + k, below[axis] + k, above[axis] + k,
                            hn::Iota(dd, static_cast<double>(axis * kRoom + k)));
        }
    }
    const CutSearch::Best best = search.best();
    if (best.cost == INFINITY) return {};
    const std::size_t axis = best.number / kRoom, i = best.number % kRoom;
    return KdCut{.axis = static_cast<int>(axis),
                 .plane = planes[axis][i],
                 .cost = best.cost,
                 .duplicates = static_cast<std::size_t>(weight * (below[axis][i] + above[axis][i] - all))};
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
