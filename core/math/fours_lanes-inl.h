// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_FOURS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_FOURS_LANES_INL_H_
#undef RAYUELA_CORE_MATH_FOURS_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_FOURS_LANES_INL_H_
#endif

#include "core/math/vec_lanes-inl.h"

// Numbers that lie side by side in a struct, of as many structs as there are lanes: loaded together and turned, which takes
// a fraction of the time of a gather of each. at(lane) points to those of a lane.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

struct FourLanes {
    Floats x, y, z, w;

    HWY_INLINE Vec3Lanes xyz() const { return {x, y, z}; }
};

/// What at(lane) points to, one number of all lanes after the other.
template <std::size_t kCount, typename Tag, typename At>
HWY_INLINE void load_singly(Tag tag, const At& at, hn::Vec<Tag> (&out)[kCount]) {
    alignas(16) hn::TFromD<Tag> rows[kCount][hn::MaxLanes(tag)];
    for (std::size_t lane = 0; lane < hn::MaxLanes(tag); ++lane) {
        for (std::size_t k = 0; k < kCount; ++k) rows[k][lane] = at(lane)[k];
    }
    for (std::size_t k = 0; k < kCount; ++k) out[k] = hn::Load(tag, rows[k]);
}

/// The way back.
template <typename Tag, typename At>
HWY_INLINE void store_singly(Tag tag, const hn::Vec<Tag> (&v)[4], const At& at) {
    alignas(16) hn::TFromD<Tag> rows[4][hn::MaxLanes(tag)];
    for (std::size_t k = 0; k < 4; ++k) hn::Store(v[k], tag, rows[k]);
    for (std::size_t lane = 0; lane < hn::MaxLanes(tag); ++lane) {
        for (std::size_t k = 0; k < 4; ++k) at(lane)[k] = rows[k][lane];
    }
}

#if HWY_TARGET == HWY_SCALAR

template <std::size_t kCount, typename Tag, typename At>
HWY_INLINE void load_turned(Tag tag, const At& at, hn::Vec<Tag> (&out)[kCount]) {
    load_singly(tag, at, out);
}

template <typename Tag, typename At>
HWY_INLINE void store_turned(Tag tag, const hn::Vec<Tag> (&v)[4], const At& at) {
    store_singly(tag, v, at);
}

#else

/// 16 bytes from at(lane) on, then those of the lane that many numbers later, and so on.
template <typename Tag, typename At>
HWY_INLINE hn::Vec<Tag> load_blocks(Tag tag, const At& at, std::size_t lane) {
    if constexpr (sizeof(hn::TFromD<Tag>) * hn::MaxLanes(tag) == 16) {
        return hn::LoadU(tag, at(lane));
    } else {
        const hn::Half<Tag> half;
        const auto lower = load_blocks(half, at, lane);
        return hn::Combine(tag, load_blocks(half, at, lane + hn::MaxLanes(half)), lower);
    }
}

template <typename Tag, typename At>
HWY_INLINE void store_blocks(Tag tag, hn::Vec<Tag> blocks, const At& at, std::size_t lane) {
    if constexpr (sizeof(hn::TFromD<Tag>) * hn::MaxLanes(tag) == 16) {
        hn::StoreU(blocks, tag, at(lane));
    } else {
        const hn::Half<Tag> half;
        store_blocks(half, hn::LowerHalf(half, blocks), at, lane);
        store_blocks(half, hn::UpperHalf(half, blocks), at, lane + hn::MaxLanes(half));
    }
}

/// Four floats a lane.
template <typename Tag, typename At>
HWY_INLINE void load_turned(Tag d, const At& at, hn::Vec<Tag> (&out)[4]) {
    if constexpr (hn::MaxLanes(d) < 4) {
        load_singly(d, at, out);
    } else {
        const auto v0 = load_blocks(d, at, 0), v1 = load_blocks(d, at, 1);
        const auto v2 = load_blocks(d, at, 2), v3 = load_blocks(d, at, 3);
        const auto low_even = hn::InterleaveLower(d, v0, v2), low_odd = hn::InterleaveLower(d, v1, v3);
        const auto high_even = hn::InterleaveUpper(d, v0, v2), high_odd = hn::InterleaveUpper(d, v1, v3);
        out[0] = hn::InterleaveLower(d, low_even, low_odd);
        out[1] = hn::InterleaveUpper(d, low_even, low_odd);
        out[2] = hn::InterleaveLower(d, high_even, high_odd);
        out[3] = hn::InterleaveUpper(d, high_even, high_odd);
    }
}

/// Two doubles a lane.
template <typename Tag, typename At>
HWY_INLINE void load_turned(Tag d, const At& at, hn::Vec<Tag> (&out)[2]) {
    const auto even = load_blocks(d, at, 0), odd = load_blocks(d, at, 1);
    out[0] = hn::InterleaveLower(d, even, odd);
    out[1] = hn::InterleaveUpper(d, even, odd);
}

/// The way back of four floats a lane.
template <typename Tag, typename At>
HWY_INLINE void store_turned(Tag d, const hn::Vec<Tag> (&v)[4], const At& at) {
    if constexpr (hn::MaxLanes(d) < 4) {
        store_singly(d, v, at);
    } else {
        const auto low_even = hn::InterleaveLower(d, v[0], v[2]), low_odd = hn::InterleaveLower(d, v[1], v[3]);
        const auto high_even = hn::InterleaveUpper(d, v[0], v[2]), high_odd = hn::InterleaveUpper(d, v[1], v[3]);
        store_blocks(d, hn::InterleaveLower(d, low_even, low_odd), at, 0);
        store_blocks(d, hn::InterleaveUpper(d, low_even, low_odd), at, 1);
        store_blocks(d, hn::InterleaveLower(d, high_even, high_odd), at, 2);
        store_blocks(d, hn::InterleaveUpper(d, high_even, high_odd), at, 3);
    }
}

#endif

template <typename At>
HWY_INLINE FourLanes load_fours(const At& at) {
    Floats v[4];
    load_turned(FloatTag(), at, v);
    return {v[0], v[1], v[2], v[3]};
}

template <typename At>
HWY_INLINE void store_fours(Floats x, Floats y, Floats z, Floats w, const At& at) {
    const Floats v[4] = {x, y, z, w};
    store_turned(FloatTag(), v, at);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
