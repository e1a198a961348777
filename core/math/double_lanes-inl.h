// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_DOUBLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_DOUBLE_LANES_INL_H_
#undef RAYUELA_CORE_MATH_DOUBLE_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_DOUBLE_LANES_INL_H_
#endif

#include "core/math/lanes-inl.h"

// Vectors in double, one a lane: the operations of glm in their order, and so the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

using DoubleTag = hn::CappedTag<double, 8>;
using Doubles = hn::Vec<DoubleTag>;

inline constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());

HWY_INLINE Doubles all_doubles(double x) {
    return hn::Set(DoubleTag(), x);
}

struct DoubleAxes {
    Doubles x, y, z;
};
HWY_INLINE DoubleAxes operator+(const DoubleAxes& a, const DoubleAxes& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE DoubleAxes operator-(const DoubleAxes& a, const DoubleAxes& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE DoubleAxes operator*(Doubles s, const DoubleAxes& v) {
    return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}
HWY_INLINE Doubles dot(const DoubleAxes& a, const DoubleAxes& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE DoubleAxes cross(const DoubleAxes& a, const DoubleAxes& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE DoubleAxes normalize(const DoubleAxes& v) {
    return hn::Div(all_doubles(1), hn::Sqrt(dot(v, v))) * v;
}
HWY_INLINE Doubles max_abs(const DoubleAxes& v) {
    return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
