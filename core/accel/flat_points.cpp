#include "core/accel/flat_points.h"

#include <algorithm>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/flat_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/surface_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Doubles load(const FlatBlock::Row& row, std::size_t i) {
    return hn::Load(DoubleTag(), row + i);
}
HWY_INLINE DoubleAxes load(const FlatBlock::Row (&rows)[3], std::size_t i) {
    return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}

/// The next kDoubles of them, as Flat has it.
HWY_INLINE void points_from(const FlatBlock& block, std::size_t i, SurfacePoint* points) {
    const Doubles one = all_doubles(1), third = all_doubles(1.0 / 3);
    const DoubleAxes a = load(block.a, i), b = load(block.b, i), c = load(block.c, i);
    const DoubleAxes e1 = b - a, e2 = c - a;
    const Doubles b1 = load(block.b1, i), b2 = load(block.b2, i);
    const auto at = [&](Doubles u, Doubles v) HWY_ATTR { return a + u * e1 + v * e2; };

    const Doubles margin = hn::Mul(all_doubles(kEdgeMargin), max_abs(at(b1, b2)));
    const Doubles share = hn::Div(hn::Mul(all_doubles(kTriangleMargins), margin), hn::Max(max_abs(e1), max_abs(e2)));
    const Doubles inward = hn::IfThenElse(hn::Lt(share, one), share, one);
    const auto moved = [&](Doubles x)
                           HWY_ATTR { return hn::Add(hn::Mul(x, hn::Sub(one, inward)), hn::Mul(third, inward)); };
    const Doubles size = hn::Add(hn::Add(hn::Add(max_abs(a), max_abs(b)), max_abs(c)), load(block.offset, i));
    store_points(
        at(moved(b1), moved(b2)), size, normalize(load(block.sign, i) * cross(e1, e2)),
        std::min(kDoubles, block.size - i), [&](std::size_t k) { return block.ray[i + k]; }, points);
}

HWY_ATTR void points_from_all(const FlatBlock& block, std::span<SurfacePoint> points) {
    for (std::size_t i = 0; i < block.size; i += kDoubles) points_from(block, i, points.data());
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(points_from_all);

void flat_points(const FlatBlock& block, std::span<SurfacePoint> points) {
    HWY_DYNAMIC_DISPATCH(points_from_all)(block, points);
}

}  // namespace rayuela
#endif
