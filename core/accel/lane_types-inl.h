// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#undef RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_LANE_TYPES_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, 16>;
using WordTag = hn::Rebind<std::uint32_t, FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Words = hn::Vec<WordTag>;
using FloatMask = hn::Mask<FloatTag>;
using DoubleTag = hn::CappedTag<double, 8>;
using Doubles = hn::Vec<DoubleTag>;

inline constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());
/// Two groups of lanes take turns: while one waits for memory the other computes.
inline constexpr std::size_t kGroups = 2, kSlots = kGroups * kLanes;

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

/// One bit a lane.
using LaneBits = std::uint32_t;

template <typename Tag>
HWY_INLINE LaneBits bits_of(Tag tag, hn::Mask<Tag> mask) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(tag, mask, reinterpret_cast<std::uint8_t*>(&bits));
    return static_cast<LaneBits>(bits);
}

HWY_INLINE FloatMask mask_of(LaneBits bits) {
    const std::uint64_t wide = bits;
    return hn::LoadMaskBits(FloatTag(), reinterpret_cast<const std::uint8_t*>(&wide));
}

HWY_INLINE std::size_t first_lane(LaneBits lanes) {
    return static_cast<std::size_t>(std::countr_zero(lanes));
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
