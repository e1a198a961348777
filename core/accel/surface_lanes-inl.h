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
#include "core/math/fours_lanes-inl.h"

#include <cstddef>
#include <type_traits>

// The way from vectors in double, one a lane, to a SurfacePoint: the operations of surface_point.cpp in their order, and so
// the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// What `rounded` makes of a Surface without shading normal and uv, one a lane; lane k becomes points[of(k)], k < count.
template <typename Of>
HWY_INLINE void store_points(const DoubleAxes& p, Doubles size, const DoubleAxes& ng, std::size_t count, Of&& of,
                             SurfacePoint* points) {
    static_assert(std::is_standard_layout_v<SurfacePoint> && offsetof(SurfacePoint, uv) == 12 * sizeof(float));
    const hn::Rebind<float, DoubleTag> df;
    SurfacePoint spare;
    SurfacePoint* to[kDoubles];
    for (std::size_t k = 0; k < kDoubles; ++k) to[k] = k < count ? &points[of(k)] : &spare;
    const auto put = [&](std::size_t offset, Doubles x, Doubles y, Doubles z, Doubles w) HWY_ATTR {
        const hn::Vec<decltype(df)> four[4] = {hn::DemoteTo(df, x), hn::DemoteTo(df, y), hn::DemoteTo(df, z),
                                               hn::DemoteTo(df, w)};
        store_turned(df, four, [&](std::size_t k) HWY_ATTR { return &to[k]->p.x + offset; });
    };
    const Doubles own = hn::Add(hn::Mul(all_doubles(kSurfaceDoubleError), size), all_doubles(kSurfaceSmallestError));
    const auto error = [&](Doubles x)
                           HWY_ATTR { return hn::Add(hn::Mul(hn::Abs(x), all_doubles(kSurfaceRounding)), own); };
    put(0, p.x, p.y, p.z, error(p.x));
    put(4, error(p.y), error(p.z), ng.x, ng.y);
    put(8, ng.z, ng.x, ng.y, ng.z);
    for (SurfacePoint* point : to) point->uv = Vec2(0);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
