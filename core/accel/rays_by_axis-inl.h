// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_RAYS_BY_AXIS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_RAYS_BY_AXIS_INL_H_
#undef RAYUELA_CORE_ACCEL_RAYS_BY_AXIS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_RAYS_BY_AXIS_INL_H_
#endif

#include "core/accel/ray_block-inl.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays of a batch by the dominant axis of their directions, otherwise in their order.
struct RaysByAxis {
    std::uint32_t ids[3][kBlockRays + kLanes];
    std::size_t size[3];

    /// `of`: at most kBlockRays, kLanes more may be read.
    HWY_INLINE void sort(std::span<const Ray> rays, std::span<const std::uint32_t> of) {
        const FloatTag d;
        const WordTag dw;
        alignas(64) std::uint32_t names[kLanes];
        std::fill_n(size, 3, 0);
        for (std::size_t i = 0; i < of.size(); i += kLanes) {
            const FloatMask all = hn::FirstN(d, of.size() - i);
            const Words id = hn::IfThenElseZero(hn::RebindMask(dw, all), hn::LoadU(dw, of.data() + i));
            hn::Store(id, dw, names);
            const auto direction =
                load_fours([&](std::size_t lane) HWY_ATTR { return &rays[names[lane]].direction.x; });
            const Floats x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
            const FloatMask x_longest = hn::And(hn::Gt(x, y), hn::Gt(x, z));
            const FloatMask y_longest = hn::AndNot(x_longest, hn::Gt(y, z));
            const FloatMask longest[3] = {x_longest, y_longest, hn::Not(hn::Or(x_longest, y_longest))};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const FloatMask mask = hn::And(longest[axis], all);
                hn::StoreU(hn::Compress(id, hn::RebindMask(dw, mask)), dw, ids[axis] + size[axis]);
                size[axis] += hn::CountTrue(d, mask);
            }
        }
    }
};

/// Makes `ids` (at most kBlockRays, kLanes more may be read) `sorted`.
inline std::span<const std::uint32_t> sort_by_axis(std::span<const Ray> rays, std::span<const std::uint32_t> ids,
                                                   std::uint32_t (&sorted)[kBlockRays]) {
    RaysByAxis by_axis;
    by_axis.sort(rays, ids);
    std::uint32_t* end = sorted;
    for (std::size_t axis = 0; axis < 3; ++axis) end = std::copy_n(by_axis.ids[axis], by_axis.size[axis], end);
    return {sorted, end};
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
