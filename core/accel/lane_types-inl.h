// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#undef RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#endif

#include "core/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Groups of lanes take turns: while one waits for memory the others compute.
inline constexpr std::size_t kGroups = 3, kSlots = kGroups * kLanes;
/// With those of a convoy behind them.
inline constexpr std::size_t kAllSlots = kSlots + kLanes;

/// Pairs of words in memory, one a lane, at which the lanes' indices point.
struct WordPairs {
    Words low, high;
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE WordPairs gather_pairs(const std::uint64_t* base, const std::uint32_t* index) {
    const WordTag dw;
    const std::uint64_t pair = base[*index];
    return {hn::Set(dw, static_cast<std::uint32_t>(pair)), hn::Set(dw, static_cast<std::uint32_t>(pair >> 32))};
}

#else

/// base[index[k]] in lane k. A load and an insertion a lane: instructions that gather take twice as long on Zen 4.
template <typename Tag>
HWY_INLINE hn::Vec<Tag> load_each(Tag d, const std::uint64_t* base, const std::uint32_t* index) {
    if constexpr (hn::MaxLanes(Tag()) == 1) {
        return hn::Load(d, base + *index);
    } else {
        const hn::Half<Tag> half;
        return hn::Combine(d, load_each(half, base, index + hn::MaxLanes(half)), load_each(half, base, index));
    }
}

using PairTag = hn::Repartition<std::uint64_t, WordTag>;

HWY_INLINE WordPairs gather_pairs(const std::uint64_t* base, const std::uint32_t* index) {
    const WordTag dw;
    const PairTag dp;
    const auto lower = hn::BitCast(dw, load_each(dp, base, index));
    const auto upper = hn::BitCast(dw, load_each(dp, base, index + hn::MaxLanes(dp)));
    return {hn::ConcatEven(dw, upper, lower), hn::ConcatOdd(dw, upper, lower)};
}

#endif

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
