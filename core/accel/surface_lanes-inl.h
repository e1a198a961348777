// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_SURFACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_SURFACE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_SURFACE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_SURFACE_LANES_INL_H_
#endif

#include "core/accel/surface_point.h"
#include "core/accel/surface_rounding.h"
#include "core/math/double_lanes-inl.h"

// The way from vectors in double, one a lane, to a SurfacePoint: the operations of surface_point.cpp in their order, and so
// the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

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
