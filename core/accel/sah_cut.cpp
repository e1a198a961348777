#include "core/accel/kd_cut.h"

#include "core/math/float_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/sah_cut.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/cut_bins-inl.h"
#include "core/accel/cut_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr std::size_t kExactLimit = 64;
/// Of larger nodes every so many-th reference is counted that at least so many are: planes are as good.
constexpr std::size_t kCounted = 1 << 13;
/// Cuts that cost so many times as much as the best may become the best when they are refined.
constexpr double kRefined = 1.1;

/// Where a box begins for a cut: a flat one before the plane in which it lies, so that it is below it.
HWY_INLINE float begin_of(const Bounds3& box, int axis) {
    return box.lo[axis] < box.hi[axis] ? box.lo[axis] : next_down(box.lo[axis]);
}

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

/// Every plane at which a box begins or ends.
HWY_INLINE std::optional<KdCut> search_exact(std::span<const KdReference> references, const Bounds3& cell,
                                             float step_cost) {
    // Rows of 8: where a box begins along x, y and z, nothing, and where it ends.
    constexpr std::size_t kRow = 8, kEnd = 4, kRoom = kExactLimit * kRow + kLanes;
    alignas(64) float planes[kRoom];
    alignas(64) std::int32_t below[kRoom], above[kRoom];
    const std::size_t n = references.size();
    for (std::size_t k = 0; k < n; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            float* const at = planes + kRow * k + axis;
            at[0] = begin_of(references[k].box, axis);
            at[kEnd] = references[k].box.hi[axis];
        }
        planes[kRow * k + 3] = planes[kRow * k + 7] = 0;
    }
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    for (std::size_t i = 0; i < n * kRow; i += kLanes) {
        const Floats plane = hn::Load(d, planes + i);
        auto is_below = hn::Zero(di), is_above = is_below;
        for (std::size_t k = 0; k < n; ++k) {
            is_below = count_up(is_below, hn::Lt(load_axes(planes + kRow * k, i), plane));
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

/// The sides of boxes across an axis that lie between two planes, in their order.
class NearSides {
public:
    NearSides(std::span<const KdReference> references, int axis, float first, float last) : boxes_(references.size()) {
        for (const KdReference& reference : references) {
            const float begin = begin_of(reference.box, axis), end = reference.box.hi[axis];
            begins_[begun_] = begin;
            ends_[ended_] = end;
            begun_ += begin > first && begin < last ? 1 : 0;
            ended_ += end > first && end < last ? 1 : 0;
            begun_before_ += begin <= first ? 1 : 0;
            ended_before_ += end <= first ? 1 : 0;
            if (begun_ == kMost || ended_ == kMost) return;
        }
        std::sort(begins_, begins_ + begun_);
        std::sort(ends_, ends_ + ended_);
    }

    /// Whether there are more than find room.
    bool too_many() const { return begun_ == kMost || ended_ == kMost; }

    /// Room for what write_planes writes, and for whole vectors.
    static constexpr std::size_t kPlanes = 2 << 11, kRoom = kPlanes + 16;

    /// Each plane at which a side lies, and the numbers of boxes below and above it. Returns how many there are.
    std::size_t write_planes(float* planes, std::int32_t* below, std::int32_t* above) const {
        std::size_t count = 0;
        for (std::size_t b = 0, e = 0; b < begun_ || e < ended_; ++count) {
            const bool is_begin = e == ended_ || (b < begun_ && begins_[b] < ends_[e]);
            const float plane = is_begin ? begins_[b] : ends_[e];
            while (e < ended_ && ends_[e] == plane) ++e;
            planes[count] = plane;
            below[count] = static_cast<std::int32_t>(begun_before_ + b);
            above[count] = static_cast<std::int32_t>(boxes_ - ended_before_ - e);
            while (b < begun_ && begins_[b] == plane) ++b;
        }
        return count;
    }

private:
    static constexpr std::size_t kMost = kPlanes / 2;

    std::size_t boxes_;
    std::size_t begun_ = 0, ended_ = 0;                ///< How many sides there are.
    std::size_t begun_before_ = 0, ended_before_ = 0;  ///< Sides at the first plane or before it.
    float begins_[kMost], ends_[kMost];
};

/// `cut` becomes the cheapest plane between two others at which a box begins or ends, if that is cheaper.
HWY_INLINE void refine(std::span<const KdReference> references, const Bounds3& cell, float step_cost, float first,
                       float last, KdCut& cut) {
    const NearSides sides(references, cut.axis, first, last);
    if (sides.too_many()) return;
    alignas(64) float planes[NearSides::kRoom];
    alignas(64) std::int32_t below[NearSides::kRoom], above[NearSides::kRoom];
    const std::size_t count = sides.write_planes(planes, below, above);
    std::fill_n(planes + count, kDoubles, cell.lo[cut.axis]);
    std::fill_n(below + count, kDoubles, 0);
    std::fill_n(above + count, kDoubles, 0);
    CutSearch search(cell, 1, step_cost);
    const CutSearch::Across across = search.across(cut.axis);
    for (std::size_t k = 0; k < count; k += kDoubles)
        search.consider(across, planes + k, below + k, above + k, hn::Iota(DoubleTag(), static_cast<double>(k)));
    const CutSearch::Best best = search.best();
    if (best.cost >= cut.cost) return;
    cut.plane = planes[best.number];
    cut.cost = best.cost;
    cut.duplicates = static_cast<std::size_t>(below[best.number] + above[best.number]) - references.size();
}

/// Planes at equal distances over what a node holds, so that the outermost cut off empty space.
class BinnedPlanes {
public:
    BinnedPlanes(std::span<const KdReference> references, const Bounds3& cell, float step_cost)
        : references_(references),
          cell_(cell),
          step_cost_(step_cost),
          stride_(std::max<std::size_t>(1, references.size() / kCounted)),
          counted_(static_cast<std::int32_t>((references.size() + stride_ - 1) / stride_)),
          held_(bounds_of(references)),
          per_unit_(float{kBins} / (held_.hi - held_.lo)),
          bins_(held_, per_unit_) {
        bins_.count(references, stride_);
    }

    /// A cut and the planes beside it.
    struct Found {
        KdCut cut;
        float before, behind;
    };

    bool all_are_counted() const { return stride_ == 1; }

    /// The cheapest of those across an axis.
    HWY_INLINE std::optional<Found> search(int axis) const {
        // Axes too flat or too long to be divided in float are left alone.
        if (!(per_unit_[axis] > 0 && per_unit_[axis] < INFINITY)) return {};
        // Room for whole vectors.
        constexpr std::size_t kRoom = kBins + 16;
        alignas(64) float planes[kRoom];
        alignas(64) std::int32_t below[kRoom], above[kRoom];
        write_planes(axis, planes, below, above);
        const double weight = static_cast<double>(references_.size()) / counted_;
        CutSearch search(cell_, weight, step_cost_);
        const CutSearch::Across across = search.across(axis);
        for (std::size_t k = 0; k <= kBins; k += kDoubles)
            search.consider(across, planes + k, below + k, above + k, hn::Iota(DoubleTag(), static_cast<double>(k)));
        const auto [cost, i] = search.best();
        if (cost == INFINITY) return {};
        return Found{.cut = {.axis = axis,
                             .plane = planes[i],
                             .cost = cost,
                             .duplicates = static_cast<std::size_t>(weight * (below[i] + above[i] - counted_))},
                     .before = i > 0 ? planes[i - 1] : cell_.lo[axis],
                     .behind = i < kBins ? planes[i + 1] : cell_.hi[axis]};
    }

private:
    /// The planes, the numbers of boxes below and above each, and some that are no cuts.
    HWY_INLINE void write_planes(int axis, float* planes, std::int32_t* below, std::int32_t* above) const {
        const FloatTag d;
        for (std::size_t k = 0; k < kBins; k += kLanes) {
            const Floats depth = hn::Div(hn::Iota(d, static_cast<float>(k)), hn::Set(d, per_unit_[axis]));
            hn::Store(hn::Add(hn::Set(d, held_.lo[axis]), depth), d, planes + k);
        }
        planes[kBins] = held_.hi[axis];
        below[0] = 0;
        above[0] = counted_;
        const auto a = static_cast<std::size_t>(axis);
        for (std::size_t k = 0; k < kBins; ++k) {
            below[k + 1] = bins_.begun(a, k);
            above[k + 1] = counted_ - bins_.ended(a, k);
        }
        // Between the outermost planes something lies on both sides, be it among what is not counted.
        for (std::size_t k = 1; k < kBins && stride_ > 1; ++k) {
            below[k] = std::max(1, below[k]);
            above[k] = std::max(1, above[k]);
        }
        std::fill_n(planes + kBins + 1, kDoubles, cell_.lo[axis]);
        std::fill_n(below + kBins + 1, kDoubles, 0);
        std::fill_n(above + kBins + 1, kDoubles, 0);
    }

    std::span<const KdReference> references_;
    Bounds3 cell_;
    float step_cost_;
    std::size_t stride_;    ///< Every so many-th reference is counted:
    std::int32_t counted_;  ///< So many.
    Bounds3 held_;
    Vec3 per_unit_;  ///< Bins by axis.
    Bins bins_;
};

HWY_INLINE std::optional<KdCut> search_binned(std::span<const KdReference> references, const Bounds3& cell,
                                              float step_cost) {
    const BinnedPlanes planes(references, cell, step_cost);
    std::optional<BinnedPlanes::Found> found[3];
    std::optional<KdCut> best;
    for (int axis = 0; axis < 3; ++axis) {
        found[axis] = planes.search(axis);
        if (found[axis] && (!best || found[axis]->cut.cost < best->cost)) best = found[axis]->cut;
    }
    if (!best || !planes.all_are_counted()) return best;
    // Others do not become cheaper than the best.
    const double most = kRefined * best->cost;
    for (std::optional<BinnedPlanes::Found>& one : found) {
        if (!one || one->cut.cost > most) continue;
        refine(references, cell, step_cost, one->before, one->behind, one->cut);
        if (one->cut.cost < best->cost) best = one->cut;
    }
    return best;
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
