// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_PRECISE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_PRECISE_LANES_INL_H_
#undef RAYUELA_CORE_MATH_PRECISE_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_PRECISE_LANES_INL_H_
#endif

#include "core/math/precise.h"

#include "core/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// rayuela::squared_distance_excess, the same to the bit.
HWY_INLINE Doubles squared_distance_excess(const DoubleAxes& a, const DoubleAxes& b, Doubles r) {
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_SSE4
    // No fused multiply-add here.
    const DoubleTag dd;
    alignas(64) double as[3][kDoubles], bs[3][kDoubles], result[kDoubles];
    const DoubleAxes* const from[] = {&a, &b};
    double(*const to[])[kDoubles] = {as, bs};
    for (std::size_t k = 0; k < 2; ++k) {
        hn::Store(from[k]->x, dd, to[k][0]);
        hn::Store(from[k]->y, dd, to[k][1]);
        hn::Store(from[k]->z, dd, to[k][2]);
    }
    hn::Store(r, dd, result);
    for (std::size_t k = 0; k < kDoubles; ++k) {
        result[k] = rayuela::squared_distance_excess(Vec3d(as[0][k], as[1][k], as[2][k]),
                                                     Vec3d(bs[0][k], bs[1][k], bs[2][k]), result[k]);
    }
    return hn::Load(dd, result);
#else
    const auto two_sum_error = [](Doubles x, Doubles y, Doubles sum) HWY_ATTR {
        const Doubles z = hn::Sub(sum, x);
        return hn::Add(hn::Sub(x, hn::Sub(sum, z)), hn::Sub(y, z));
    };
    Doubles sum = hn::Neg(hn::Mul(r, r)), errors = hn::Neg(hn::MulAdd(r, r, sum));
    const auto add = [&](Doubles x, Doubles y) HWY_ATTR {
        const Doubles difference = hn::Sub(x, y), lost = two_sum_error(x, hn::Neg(y), difference);
        const Doubles square = hn::Mul(difference, difference), next = hn::Add(sum, square);
        const Doubles twice = hn::Mul(hn::Mul(hn::Set(DoubleTag(), 2), difference), lost);
        errors = hn::Add(errors, hn::Add(hn::Add(hn::MulSub(difference, difference, square), twice),
                                         two_sum_error(sum, square, next)));
        sum = next;
    };
    add(a.x, b.x);
    add(a.y, b.y);
    add(a.z, b.z);
    return hn::Add(sum, errors);
#endif
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
