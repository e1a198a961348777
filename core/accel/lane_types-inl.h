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

/// Pairs of words in memory, one a lane, at which the lanes' indices point.
struct WordPairs {
    Words low, high;
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE WordPairs gather_pairs(const std::uint64_t* base, Words index) {
    const WordTag dw;
    const std::uint64_t pair = base[hn::GetLane(index)];
    return {hn::Set(dw, static_cast<std::uint32_t>(pair)), hn::Set(dw, static_cast<std::uint32_t>(pair >> 32))};
}

HWY_INLINE void scatter_pairs(const WordPairs& pairs, std::uint64_t* base, Words index) {
    base[hn::GetLane(index)] = hn::GetLane(pairs.low) | std::uint64_t{hn::GetLane(pairs.high)} << 32;
}

#else

using PairTag = hn::Repartition<std::uint64_t, WordTag>;
using PairIndexTag = hn::RebindToSigned<PairTag>;
using Pairs = hn::Vec<PairTag>;

HWY_INLINE WordPairs gather_pairs(const std::uint64_t* base, Words index) {
    const WordTag dw;
    const PairTag dp;
    const PairIndexTag di;
    // Lanes with even numbers and lanes with odd numbers, each index in the low half of its pair.
    const Pairs both = hn::BitCast(dp, index);
    const Pairs even_index = hn::And(both, hn::Set(dp, 0xffffffffu)), odd_index = hn::ShiftRight<32>(both);
    const Pairs even = hn::GatherIndex(dp, base, hn::BitCast(di, even_index));
    const Pairs odd = hn::GatherIndex(dp, base, hn::BitCast(di, odd_index));
    return {hn::OddEven(hn::BitCast(dw, hn::ShiftLeft<32>(odd)), hn::BitCast(dw, even)),
            hn::OddEven(hn::BitCast(dw, odd), hn::BitCast(dw, hn::ShiftRight<32>(even)))};
}

HWY_INLINE void scatter_pairs(const WordPairs& pairs, std::uint64_t* base, Words index) {
    const WordTag dw;
    const PairTag dp;
    const PairIndexTag di;
    const Pairs both = hn::BitCast(dp, index);
    const Pairs even_index = hn::And(both, hn::Set(dp, 0xffffffffu)), odd_index = hn::ShiftRight<32>(both);
    const Pairs low = hn::BitCast(dp, pairs.low), high = hn::BitCast(dp, pairs.high);
    const Pairs even = hn::BitCast(dp, hn::OddEven(hn::BitCast(dw, hn::ShiftLeft<32>(high)), pairs.low));
    const Pairs odd = hn::BitCast(dp, hn::OddEven(pairs.high, hn::BitCast(dw, hn::ShiftRight<32>(low))));
    hn::ScatterIndex(even, dp, base, hn::BitCast(di, even_index));
    hn::ScatterIndex(odd, dp, base, hn::BitCast(di, odd_index));
}

#endif

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
