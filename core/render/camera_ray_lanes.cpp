#include "core/render/camera_rays.h"

#include <algorithm>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/camera_ray_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/math/double_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

class CameraLanes {
public:
    HWY_INLINE explicit CameraLanes(const CameraModel& model) : model_(model) {}

    /// n (at most kDoubles) rays. `positions` and `lens` can be read kDoubles far; `lens` may be null.
    HWY_INLINE void write(const Vec2* positions, const Vec2* lens, std::size_t n, Ray* rays) const {
        const HalfFloatTag df;
        const DoublePair position = load(positions);
        const DoubleAxes to = axes(model_.corner) + position.x * axes(model_.across) + position.y * axes(model_.down);
        DoubleAxes from = axes(model_.origin), along = to;
        if (lens) {
            const DoublePair at = load(lens);
            // Relative to the lens centre: the distance to the focus plane is not lost in the camera's coordinates.
            const DoubleAxes offset =
                all_doubles(model_.lens_radius) * (at.x * axes(model_.right) + at.y * axes(model_.up));
            from = from + offset;
            along = all_doubles(model_.focus_distance) * to - offset;
        }
        const DoubleAxes direction = normalize(along);
        const auto narrow = [&](Doubles value) HWY_ATTR { return hn::DemoteTo(df, value); };
        Ray written[kDoubles];
        const hn::Vec<HalfFloatTag> begin[4] = {narrow(from.x), narrow(from.y), narrow(from.z), hn::Zero(df)};
        const hn::Vec<HalfFloatTag> end[4] = {narrow(direction.x), narrow(direction.y), narrow(direction.z),
                                              hn::Set(df, kInfinity)};
        Ray* const to_rays = n == kDoubles ? rays : written;
        store_turned(df, begin, [&](std::size_t lane) HWY_ATTR { return &to_rays[lane].origin.x; });
        store_turned(df, end, [&](std::size_t lane) HWY_ATTR { return &to_rays[lane].direction.x; });
        if (to_rays != rays) std::copy_n(written, n, rays);
    }

private:
    using HalfFloatTag = hn::Rebind<float, DoubleTag>;
    struct DoublePair {
        Doubles x, y;
    };

    static HWY_INLINE DoublePair load(const Vec2* values) {
        static_assert(sizeof(Vec2) == 2 * sizeof(float));
        hn::Vec<HalfFloatTag> x, y;
        hn::LoadInterleaved2(HalfFloatTag(), &values->x, x, y);
        return {hn::PromoteTo(DoubleTag(), x), hn::PromoteTo(DoubleTag(), y)};
    }
    static HWY_INLINE DoubleAxes axes(const Vec3d& v) { return {all_doubles(v.x), all_doubles(v.y), all_doubles(v.z)}; }

    const CameraModel& model_;
};

HWY_ATTR void write_rays(const CameraModel& model, std::span<const Vec2> positions, std::span<const Vec2> lens,
                         std::span<Ray> rays) {
    const CameraLanes camera(model);
    const bool with_lens = model.lens_radius != 0;
    const std::size_t whole = positions.size() / kDoubles * kDoubles, rest = positions.size() - whole;
    for (std::size_t i = 0; i < whole; i += kDoubles)
        camera.write(&positions[i], with_lens ? &lens[i] : nullptr, kDoubles, &rays[i]);
    if (rest == 0) return;
    Vec2 last_positions[kDoubles] = {}, last_lens[kDoubles] = {};
    std::copy_n(&positions[whole], rest, last_positions);
    if (with_lens) std::copy_n(&lens[whole], rest, last_lens);
    camera.write(last_positions, with_lens ? last_lens : nullptr, rest, &rays[whole]);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(write_rays);

void CameraRays::rays(std::span<const Vec2> positions, std::span<const Vec2> lens, std::span<Ray> rays) const {
    HWY_DYNAMIC_DISPATCH(write_rays)(model_, positions, lens, rays);
}

}  // namespace rayuela
#endif
