// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_DOUBLE_AXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_DOUBLE_AXES_INL_H_
#undef RAYUELA_CORE_ACCEL_DOUBLE_AXES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_DOUBLE_AXES_INL_H_
#endif

#include "core/accel/lane_types-inl.h"
#include "core/accel/surface_point.h"
#include "core/accel/surface_rounding.h"

// Vectors in double, one a lane, and the way from them to a SurfacePoint: the operations of glm and of surface_point.cpp in
// their order, and so the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());

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

/// What `rounded` makes of a Surface without shading normal and uv, one a lane; lane k becomes points[of(k)], k < count.
template <typename Of>
HWY_INLINE void store_points(const DoubleAxes& p, Doubles size, const DoubleAxes& ng, std::size_t count, Of&& of,
                             SurfacePoint* points) {
    const hn::Rebind<float, DoubleTag> df;
    alignas(64) float rows[9][kDoubles];
    const auto put = [&](const DoubleAxes& v, std::size_t row) HWY_ATTR {
        hn::Store(hn::DemoteTo(df, v.x), df, rows[row]);
        hn::Store(hn::DemoteTo(df, v.y), df, rows[row + 1]);
        hn::Store(hn::DemoteTo(df, v.z), df, rows[row + 2]);
    };
    const Doubles own = hn::Add(hn::Mul(all_doubles(kSurfaceDoubleError), size), all_doubles(kSurfaceSmallestError));
    const auto error = [&](Doubles x)
                           HWY_ATTR { return hn::Add(hn::Mul(hn::Abs(x), all_doubles(kSurfaceRounding)), own); };
    put(p, 0);
    put({error(p.x), error(p.y), error(p.z)}, 3);
    put(ng, 6);
    for (std::size_t k = 0; k < count; ++k) {
        const auto vec = [&](std::size_t row) { return Vec3(rows[row][k], rows[row + 1][k], rows[row + 2][k]); };
        // Member by member: a whole that is copied waits for its parts to be stored.
        SurfacePoint& point = points[of(k)];
        point.p = vec(0);
        point.p_error = vec(3);
        point.ng = vec(6);
        point.ns = vec(6);
        point.uv = Vec2(0);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
