// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_LANES_INL_H_
#undef RAYUELA_CORE_MATH_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_LANES_INL_H_
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

inline constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

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
