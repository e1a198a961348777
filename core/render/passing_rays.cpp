#include "core/render/passing_rays.h"

#include <algorithm>
#include <cmath>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/passing_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/math/double_lanes-inl.h"
#include "core/math/float_error.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Of origin and bounds: more than the 10 roundings by which trees pass their bounds early and late, see RayBlock.
inline constexpr double kTolerance = 16 * double{kUnitRoundoff};

/// The rays of the lanes that pass the bounds by. `reach` is the largest coordinate of the bounds.
template <typename At>
HWY_INLINE LaneBits passing(const Bounds3& bounds, double reach, const At& at) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    hn::Vec<decltype(df)> from[4], along[4];
    load_turned(
        df, [&](std::size_t lane) HWY_ATTR { return &at(lane).origin.x; }, from);
    load_turned(
        df, [&](std::size_t lane) HWY_ATTR { return &at(lane).direction.x; }, along);
    const auto exact = [&](hn::Vec<decltype(df)> value) HWY_ATTR { return hn::PromoteTo(dd, value); };
    const Doubles farthest = max_abs({exact(from[0]), exact(from[1]), exact(from[2])});
    const Doubles margin = hn::Mul(all_doubles(kTolerance), hn::Add(all_doubles(reach), farthest));
    Doubles enter = all_doubles(0), leave = all_doubles(INFINITY);
    for (int axis = 0; axis < 3; ++axis) {
        const Doubles origin = exact(from[axis]), inverse = hn::Div(all_doubles(1), exact(along[axis]));
        const Doubles lo = hn::Sub(all_doubles(bounds.lo[axis]), margin),
                      hi = hn::Add(all_doubles(bounds.hi[axis]), margin);
        const Doubles a = hn::Mul(hn::Sub(lo, origin), inverse), b = hn::Mul(hn::Sub(hi, origin), inverse);
        // Comparisons leave out a NaN, of a ray along the face.
        const auto forwards = hn::Lt(a, b);
        const Doubles near = hn::IfThenElse(hn::Lt(b, a), b, a), far = hn::IfThenElse(forwards, b, a);
        enter = hn::IfThenElse(hn::Gt(near, enter), near, enter);
        leave = hn::IfThenElse(hn::Lt(far, leave), far, leave);
    }
    return bits_of(dd, hn::Gt(enter, leave));
}

HWY_ATTR void find_passing(const Bounds3& bounds, double reach, std::span<const Ray> rays,
                           std::span<std::uint8_t> passes) {
    for (std::size_t i = 0; i < rays.size(); i += kDoubles) {
        const std::size_t n = std::min(kDoubles, rays.size() - i);
        const LaneBits bits = passing(
            bounds, reach, [&](std::size_t lane) HWY_ATTR -> const Ray& { return rays[i + std::min(lane, n - 1)]; });
        for (std::size_t k = 0; k < n; ++k) passes[i + k] = bits >> k & 1;
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(find_passing);

PassingRays::PassingRays(const Accelerator& accelerator, const CameraRays& camera) : bounds_(accelerator.bounds()) {
    const auto is_plane = [](const GeometryInstance& one) { return std::holds_alternative<Plane>(one.shape); };
    if (std::ranges::any_of(accelerator.instances(), is_plane)) return;
    if (!bounds_.empty()) reach_ = double{max_component(glm::max(glm::abs(bounds_.lo), glm::abs(bounds_.hi)))};
    // As the bounds are convex, the view is within them where its corners are.
    const Vec2 corners[] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    possible_ = std::ranges::any_of(corners, [&](const Vec2& corner) { return passes(camera.ray(corner, Vec2(0))); });
}

void PassingRays::find(std::span<const Ray> rays, std::span<std::uint8_t> passes) const {
    if (bounds_.empty()) {
        std::ranges::fill(passes, std::uint8_t{1});
    } else {
        HWY_DYNAMIC_DISPATCH(find_passing)(bounds_, reach_, rays, passes);
    }
}

bool PassingRays::passes(const Ray& ray) const {
    std::uint8_t result = 0;
    find({&ray, 1}, {&result, 1});
    return result != 0;
}

}  // namespace rayuela
#endif
