#include "core/accel/sphere_points.h"

#include <algorithm>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/sphere_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/surface_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"
#include "core/math/precise_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Up to kDoubles of them.
HWY_INLINE void points_of(const SphereD* spheres, std::span<const SphereHit> found, const Ray* rays, const Hit* hits,
                          SurfacePoint* points) {
    static_assert(sizeof(SphereD) == 4 * sizeof(double));
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    const auto one = [&](std::size_t lane) { return found[std::min(lane, found.size() - 1)]; };
    hn::Vec<decltype(df)> origin[4], direction[4], hit[4];
    load_turned(
        df, [&](std::size_t lane) HWY_ATTR { return &rays[one(lane).ray].origin.x; }, origin);
    load_turned(
        df, [&](std::size_t lane) HWY_ATTR { return &rays[one(lane).ray].direction.x; }, direction);
    load_turned(
        df, [&](std::size_t lane) HWY_ATTR { return &hits[one(lane).ray].t; }, hit);
    Doubles place[2], rest[2];
    load_turned(
        dd, [&](std::size_t lane) HWY_ATTR { return &spheres[one(lane).sphere].center.x; }, place);
    load_turned(
        dd, [&](std::size_t lane) HWY_ATTR { return &spheres[one(lane).sphere].center.z; }, rest);
    const DoubleAxes center{place[0], place[1], rest[0]};
    const Doubles radius = rest[1], t = hn::PromoteTo(dd, hit[0]);
    const auto advanced = [&](int axis) HWY_ATTR {
        return hn::Add(hn::PromoteTo(dd, origin[axis]), hn::Mul(t, hn::PromoteTo(dd, direction[axis])));
    };
    const DoubleAxes along{advanced(0), advanced(1), advanced(2)};
    const DoubleAxes from_center = along - center;
    const Doubles distance = hn::Sqrt(dot(from_center, from_center));
    const DoubleAxes n{hn::Div(from_center.x, distance), hn::Div(from_center.y, distance),
                       hn::Div(from_center.z, distance)};
    const Doubles height = hn::Div(squared_distance_excess(along, center, radius), hn::Add(distance, radius));
    const DoubleAxes p = along - height * n;
    store_points(
        p, max_abs(p), normalize(n), found.size(), [&](std::size_t k) { return found[k].ray; }, points);
}

HWY_ATTR void points_of_all(std::span<const SphereD> spheres, std::span<const SphereHit> found,
                            std::span<const Ray> rays, std::span<const Hit> hits, std::span<SurfacePoint> points) {
    for (std::size_t i = 0; i < found.size(); i += kDoubles) {
        points_of(spheres.data(), found.subspan(i, std::min(kDoubles, found.size() - i)), rays.data(), hits.data(),
                  points.data());
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(points_of_all);

void sphere_points(std::span<const SphereD> spheres, std::span<const SphereHit> found, std::span<const Ray> rays,
                   std::span<const Hit> hits, std::span<SurfacePoint> points) {
    HWY_DYNAMIC_DISPATCH(points_of_all)(spheres, found, rays, hits, points);
}

}  // namespace rayuela
#endif
