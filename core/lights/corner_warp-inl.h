// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_LIGHTS_CORNER_WARP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_LIGHTS_CORNER_WARP_INL_H_
#undef RAYUELA_CORE_LIGHTS_CORNER_WARP_INL_H_
#else
#define RAYUELA_CORE_LIGHTS_CORNER_WARP_INL_H_
#endif

#include "core/lights/corner_warp.h"
#include "core/math/vec_lanes-inl.h"

// What corner_warp.h does, one receiver a lane, to the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

struct CornerWarpLanes {
    Floats weights[4];

    HWY_INLINE Vec2Lanes sample(const Vec2Lanes& u) const {
        const Floats y = sample_linear(u.y, weights[0] + weights[1], weights[2] + weights[3]);
        return {sample_linear(u.x, between(y, 0), between(y, 1)), y};
    }
    HWY_INLINE Floats density(const Vec2Lanes& position) const {
        const Floats left = between(position.y, 0), right = between(position.y, 1);
        const Floats mean = all_lanes(0.25f) * ((weights[0] + weights[1]) + (weights[2] + weights[3]));
        return (left + position.x * (right - left)) / mean;
    }

private:
    HWY_INLINE Floats between(Floats y, std::size_t column) const {
        return weights[column] + y * (weights[column + 2] - weights[column]);
    }
};

HWY_INLINE CornerWarpLanes corner_warp(const Floats (&w)[4], FloatMask usable) {
    const Floats one = all_lanes(1.0f);
    const Floats scale = one / hn::Max(hn::Max(w[0], w[1]), hn::Max(w[2], w[3]));
    usable = hn::And(usable, hn::Lt(scale, all_lanes(kInfinity)));
    CornerWarpLanes warp;
    for (std::size_t i = 0; i < 4; ++i)
        warp.weights[i] = hn::IfThenElse(usable, hn::Max(w[i] * scale, all_lanes(kLeastCornerShare)), one);
    return warp;
}

HWY_INLINE CornerWarpLanes corner_warp(const Vec3Lanes (&corners)[4], const Vec3Lanes& n) {
    const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f), infinity = all_lanes(kInfinity);
    Floats d2[4];
    for (std::size_t i = 0; i < 4; ++i) d2[i] = dot(corners[i], corners[i]);
    const Floats unit = one / hn::Max(hn::Max(d2[0], d2[1]), hn::Max(d2[2], d2[3]));
    for (Floats& distance2 : d2) distance2 = distance2 * unit;
    const Floats d01 = d2[0] * d2[1], d23 = d2[2] * d2[3];
    const Floats closeness[] = {d2[1] * d23, d2[0] * d23, d01 * d2[3], d01 * d2[2]};
    const FloatMask everywhere = is_black(n);
    Floats weights[4];
    for (std::size_t i = 0; i < 4; ++i) {
        const Floats height = hn::IfThenElse(everywhere, one, hn::Max(dot(n, corners[i]), zero));
        weights[i] = closeness[i] * closeness[i] * height;
    }
    return corner_warp(weights, hn::And(hn::Gt(unit, zero), hn::Lt(unit, infinity)));
}

HWY_INLINE CornerWarpLanes cosine_warp(const Vec3Lanes (&corners)[4], const Floats (&closeness)[4],
                                       const Vec3Lanes& n) {
    Floats weights[4];
    for (std::size_t i = 0; i < 4; ++i) weights[i] = closeness[i] * hn::Max(dot(n, corners[i]), hn::Zero(FloatTag()));
    return corner_warp(weights, hn::Not(is_black(n)));
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
