// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_RAY_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_RAY_BLOCK_INL_H_
#undef RAYUELA_CORE_ACCEL_RAY_BLOCK_INL_H_
#else
#define RAYUELA_CORE_ACCEL_RAY_BLOCK_INL_H_
#endif

#include "core/accel/kd_tree.h"
#include "core/accel/traced_object.h"
#include "core/math/float_error.h"

#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <span>

#include "core/accel/lane_types-inl.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays that are traced together: enough to keep the lanes full, few enough for the cache.
inline constexpr std::size_t kBlockRays = 1024;

/// RayBlock::depth_pad for a direction of depth 1 or less: above what a t loses that is too small for a float.
inline constexpr float kLeastDepthPad = 0x1p-148f;

/// Rays in the space of one kd-tree, prepared for the float traversal and for the exact tests of triangles. The traversal
/// is conservative: it reaches a leaf of every primitive with which the exact tests in double find a hit, so that a tree gives
/// the hits of a list bit for bit.
///
/// A hit point lies in a cell of the tree and off the ray, at the float t, by less than 2^-38 of the primitive + u |t d|. The
/// distance to a plane, (plane - origin) * (1 / direction), is computed within 4u |plane - origin| (rounding of the ray to
/// float, the subtraction, the reciprocal and the product) and u |origin| for the shift. Every plane is therefore passed
/// 10u (|origin| + |bounds|) early and late.
struct RayBlock {
    static constexpr std::size_t kRoom = kBlockRays + hn::MaxLanes(DoubleTag());

    std::size_t size = 0;
    std::uint32_t id[kRoom];  ///< Which of the batch.
    alignas(64) float origin[3][kRoom];
    /// Finite, so that no product is NaN: where the direction is 0 the sign of the difference decides alone.
    alignas(64) float inverse[3][kRoom];
    alignas(64) float pad[kRoom];  ///< Distance from a plane within which both sides count.
    /// By how much the depths of vertices along the dominant axis may be off beside their rounding. Where the ray and the
    /// corners are what the scene says, that is no more than what a t loses that is too small for a float: so a ray that
    /// leaves a wall across that axis is clearly in front of it.
    alignas(64) float depth_pad[kRoom];
    alignas(64) float t_scale[kRoom];  ///< Traversal counts t in this multiple: 1 but for directions of extreme length.
    /// Where the ray may meet the tree's bounds; empty, begin > end, where it does not.
    alignas(64) float begin[kRoom], end[kRoom];
    alignas(64) float limit[kRoom];  ///< What begins behind it does not count.

    /// Whether ray i has to be traced through the tree.
    bool is_open(std::size_t i) const { return begin[i] <= end[i]; }
    void close(std::size_t i) {
        begin[i] = 0;
        end[i] = -kInfinity;
    }

    // As in TriangleRay, in the turn of the axes that makes the dominant one z.
    alignas(64) std::uint32_t dominant_axis[kRoom];
    alignas(64) double turned_origin[3][kRoom];
    alignas(64) double shear_x[kRoom], shear_y[kRoom], inverse_z[kRoom];
    alignas(64) float depth[kRoom];  ///< Of the direction along z, with its sign.
};

/// kLanes doubles, rounded.
HWY_INLINE Floats demoted(const double* values) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    alignas(64) float rounded[kLanes];
    for (std::size_t i = 0; i < kLanes; i += kDoubles)
        hn::Store(hn::DemoteTo(df, hn::LoadU(dd, values + i)), df, rounded + i);
    return hn::Load(FloatTag(), rounded);
}

struct DoubleVec3 {
    Doubles x, y, z;
};

/// The product as glm forms it.
HWY_INLINE DoubleVec3 multiply(const glm::dmat3& m, const DoubleVec3& v) {
    const DoubleTag d;
    const auto row = [&](int i) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0][i]), v.x), hn::Mul(hn::Set(d, m[1][i]), v.y)),
                       hn::Mul(hn::Set(d, m[2][i]), v.z));
    };
    return {row(0), row(1), row(2)};
}

/// Prepares rays `ids` (at most kBlockRays) of a batch, up to the closest hits so far. `object` is the one whose space is the
/// tree's; null for the world. `bounds` are the tree's, `all` hold what stands apart as well.
class RayBlockWriter {
public:
    RayBlockWriter(std::span<const Ray> rays, std::span<const Hit> hits, const TracedObject* object,
                   const Bounds3& bounds, const Bounds3& all)
        : rays_(rays.data()),
          hits_(hits.data()),
          to_local_(object && !object->in_world ? &object->to_local : nullptr),
          own_space_(object != nullptr),
          bounds_(bounds),
          reach_(rayuela::max_component(glm::max(glm::abs(all.lo), glm::abs(all.hi)))) {}

    HWY_INLINE void write(std::span<const std::uint32_t> ids, RayBlock& block) const {
        block.size = ids.size();
        std::copy(ids.begin(), ids.end(), block.id);
        std::fill_n(block.id + ids.size(), kStep, ids.empty() ? 0 : ids.back());
        for (std::size_t i = 0; i < ids.size(); i += kStep) write(block, i);
    }

private:
    using HalfFloatTag = hn::Rebind<float, DoubleTag>;
    using HalfWordTag = hn::Rebind<std::uint32_t, DoubleTag>;
    using HalfFloats = hn::Vec<HalfFloatTag>;
    static constexpr std::size_t kStep = hn::MaxLanes(DoubleTag());
    /// Relative.
    static constexpr double kBoundsTolerance = 0x1p-21;

    HWY_INLINE void write(RayBlock& block, std::size_t i) const {
        static_assert(sizeof(Ray) == 8 * sizeof(float) && sizeof(Hit) == 6 * sizeof(float));
        const DoubleTag dd;
        const HalfFloatTag df;
        const std::uint32_t* const id = block.id + i;
        HalfFloats from[4], along[4], hit[4];
        load_turned(
            df, [&](std::size_t lane) HWY_ATTR { return &rays_[id[lane]].origin.x; }, from);
        load_turned(
            df, [&](std::size_t lane) HWY_ATTR { return &rays_[id[lane]].direction.x; }, along);
        load_turned(
            df, [&](std::size_t lane) HWY_ATTR { return &hits_[id[lane]].t; }, hit);
        const auto& [px, py, pz, t_min] = from;
        const auto& [vx, vy, vz, t_max] = along;
        const HalfFloats best = hit[0];
        auto usable = can_hit(px, py, pz, vx, vy, vz, t_min, t_max);

        DoubleVec3 o{hn::PromoteTo(dd, px), hn::PromoteTo(dd, py), hn::PromoteTo(dd, pz)};
        DoubleVec3 d{hn::PromoteTo(dd, vx), hn::PromoteTo(dd, vy), hn::PromoteTo(dd, vz)};
        if (to_local_) {
            o = multiply(to_local_->linear, o);
            o = {hn::Add(o.x, hn::Set(dd, to_local_->translation.x)),
                 hn::Add(o.y, hn::Set(dd, to_local_->translation.y)),
                 hn::Add(o.z, hn::Set(dd, to_local_->translation.z))};
            d = multiply(to_local_->linear, d);
        }
        if (own_space_ && !near_bounds(o)) usable = hn::And(usable, may_meet_bounds(o, d));
        write_turned(block, i, o, d);
        const Doubles scale = t_scale(d);
        DoubleVec3 scaled = d;
        if (HWY_UNLIKELY(!hn::AllTrue(dd, hn::Eq(scale, hn::Set(dd, 1))))) {
            const Doubles per_scale = hn::Div(hn::Set(dd, 1), scale);
            scaled = {hn::Mul(d.x, per_scale), hn::Mul(d.y, per_scale), hn::Mul(d.z, per_scale)};
        }
        write_planes(block, i, o, scaled, hn::DemoteTo(df, scale), t_min, hn::Min(t_max, best), usable);
        write_depth_pad(block, i, d);
    }

    /// rayuela::can_hit.
    static HWY_INLINE hn::Mask<HalfFloatTag> can_hit(HalfFloats px, HalfFloats py, HalfFloats pz, HalfFloats vx,
                                                     HalfFloats vy, HalfFloats vz, HalfFloats t_min, HalfFloats t_max) {
        const HalfFloatTag df;
        const HalfFloats zero = hn::Zero(df);
        const auto sum = [](HalfFloats a, HalfFloats b, HalfFloats c) HWY_ATTR { return hn::Add(hn::Add(a, b), c); };
        const HalfFloats nothing = hn::Add(sum(hn::Mul(px, zero), hn::Mul(py, zero), hn::Mul(pz, zero)),
                                           sum(hn::Mul(vx, zero), hn::Mul(vy, zero), hn::Mul(vz, zero)));
        const HalfFloats length = hn::Max(hn::Abs(vx), hn::Max(hn::Abs(vy), hn::Abs(vz)));
        return hn::And(hn::Eq(nothing, zero), hn::And(hn::Gt(length, zero), hn::Le(t_min, t_max)));
    }

    /// Whether the float traversal can tell which of the rays pass the bounds by.
    HWY_INLINE bool near_bounds(const DoubleVec3& o) const {
        const DoubleTag dd;
        constexpr double kNear = 256;
        const Doubles farthest = hn::Max(hn::Abs(o.x), hn::Max(hn::Abs(o.y), hn::Abs(o.z)));
        return hn::AllTrue(dd, hn::Le(farthest, hn::Set(dd, kNear * double{reach_})));
    }

    /// False only for rays whose line passes the bounds by, where the exact tests see this very ray. In double, for origins
    /// so far away that pads in float would have all rays enter. The tolerance, relative, is far above what the exact tests
    /// and these operations are off by.
    HWY_INLINE hn::Mask<HalfFloatTag> may_meet_bounds(const DoubleVec3& o, const DoubleVec3& d) const {
        const DoubleTag dd;
        const Doubles tolerance = hn::Set(dd, kBoundsTolerance);
        const Doubles origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
        Doubles enter = hn::Set(dd, -INFINITY), leave = hn::Set(dd, INFINITY);
        for (int axis = 0; axis < 3; ++axis) {
            const Doubles lo = hn::Set(dd, bounds_.lo[axis]), hi = hn::Set(dd, bounds_.hi[axis]);
            const Doubles reach = hn::Add(hn::Max(hn::Abs(lo), hn::Abs(hi)), hn::Abs(origin[axis]));
            const Doubles margin = hn::Mul(tolerance, hn::Max(reach, hn::Set(dd, reach_)));
            const Doubles to_lo = hn::Sub(hn::Sub(lo, margin), origin[axis]),
                          to_hi = hn::Sub(hn::Add(hi, margin), origin[axis]);
            const auto still = hn::Eq(direction[axis], hn::Zero(dd));
            const Doubles a = hn::Div(to_lo, direction[axis]), b = hn::Div(to_hi, direction[axis]);
            const Doubles far = hn::Set(dd, INFINITY);
            const auto outside = hn::Or(hn::Gt(to_lo, hn::Zero(dd)), hn::Lt(to_hi, hn::Zero(dd)));
            const Doubles near_t = hn::IfThenElse(still, hn::IfThenElse(outside, far, hn::Neg(far)), hn::Min(a, b));
            const Doubles far_t = hn::IfThenElse(still, hn::IfThenElse(outside, hn::Neg(far), far), hn::Max(a, b));
            enter = hn::IfThenElse(hn::Gt(near_t, enter), near_t, enter);
            leave = hn::IfThenElse(hn::Lt(far_t, leave), far_t, leave);
        }
        const Doubles size = hn::Max(hn::Abs(enter), hn::Abs(leave));
        const auto apart = hn::Gt(hn::Sub(enter, leave), hn::Mul(tolerance, size));
        const auto passes_by =
            hn::Or(apart, hn::And(hn::Eq(enter, hn::Set(dd, INFINITY)), hn::Eq(leave, hn::Set(dd, -INFINITY))));
        // In the half as many bits of float lanes.
        const HalfFloatTag df;
        return hn::Eq(hn::DemoteTo(df, hn::IfThenElseZero(passes_by, hn::Set(dd, 1))), hn::Zero(df));
    }

    /// 1 unless the direction's length would take float traversal to its limits.
    static HWY_INLINE Doubles t_scale(const DoubleVec3& d) {
        const DoubleTag dd;
        const Doubles longest = hn::Max(hn::Abs(d.x), hn::Max(hn::Abs(d.y), hn::Abs(d.z)));
        const auto common = hn::And(hn::Gt(longest, hn::Set(dd, 0x1p-60)), hn::Lt(longest, hn::Set(dd, 0x1p60)));
        if (HWY_LIKELY(hn::AllTrue(dd, common))) return hn::Set(dd, 1);
        alignas(64) double lengths[kStep];
        hn::Store(longest, dd, lengths);
        for (double& length : lengths) {
            const bool extreme = length > 0 && length < INFINITY && !(length > 0x1p-60 && length < 0x1p60);
            length = extreme ? std::exp2(std::clamp(std::ilogb(length), -126, 126)) : 1;
        }
        return hn::Load(dd, lengths);
    }

    static HWY_INLINE void write_turned(RayBlock& block, std::size_t i, const DoubleVec3& o, const DoubleVec3& d) {
        const DoubleTag dd;
        const hn::RebindToUnsigned<DoubleTag> du;
        const Doubles x = hn::Abs(d.x), y = hn::Abs(d.y), z = hn::Abs(d.z);
        const auto x_longest = hn::And(hn::Gt(x, y), hn::Gt(x, z));
        const auto y_longest = hn::AndNot(x_longest, hn::Gt(y, z));
        const auto turned = [&](Doubles if_x, Doubles if_y, Doubles if_z) HWY_ATTR {
            return hn::IfThenElse(x_longest, if_x, hn::IfThenElse(y_longest, if_y, if_z));
        };
        const auto axis = hn::IfThenElse(hn::RebindMask(du, x_longest), hn::Zero(du),
                                         hn::IfThenElse(hn::RebindMask(du, y_longest), hn::Set(du, 1), hn::Set(du, 2)));
        hn::StoreU(hn::TruncateTo(HalfWordTag(), axis), HalfWordTag(), block.dominant_axis + i);
        hn::StoreU(turned(o.y, o.z, o.x), dd, block.turned_origin[0] + i);
        hn::StoreU(turned(o.z, o.x, o.y), dd, block.turned_origin[1] + i);
        hn::StoreU(turned(o.x, o.y, o.z), dd, block.turned_origin[2] + i);
        const Doubles depth = turned(d.x, d.y, d.z), inverse = hn::Div(hn::Set(dd, 1), depth);
        hn::StoreU(hn::DemoteTo(HalfFloatTag(), depth), HalfFloatTag(), block.depth + i);
        hn::StoreU(hn::Mul(turned(d.y, d.z, d.x), inverse), dd, block.shear_x + i);
        hn::StoreU(hn::Mul(turned(d.z, d.x, d.y), inverse), dd, block.shear_y + i);
        hn::StoreU(inverse, dd, block.inverse_z + i);
    }

    HWY_INLINE void write_planes(RayBlock& block, std::size_t i, const DoubleVec3& o, const DoubleVec3& d,
                                 HalfFloats scale, HalfFloats t_min, HalfFloats t_max,
                                 hn::Mask<HalfFloatTag> usable) const {
        const HalfFloatTag df;
        const HalfFloats origin[3] = {hn::DemoteTo(df, o.x), hn::DemoteTo(df, o.y), hn::DemoteTo(df, o.z)};
        const HalfFloats direction[3] = {hn::DemoteTo(df, d.x), hn::DemoteTo(df, d.y), hn::DemoteTo(df, d.z)};
        const HalfFloats farthest = hn::Max(hn::Abs(origin[0]), hn::Max(hn::Abs(origin[1]), hn::Abs(origin[2])));
        const HalfFloats pad = hn::Mul(hn::Set(df, 10 * kUnitRoundoff), hn::Add(farthest, hn::Set(df, reach_)));
        HalfFloats begin = hn::Mul(t_min, scale), end = hn::Mul(t_max, scale);
        hn::StoreU(end, df, block.limit + i);
        for (int axis = 0; axis < 3; ++axis) {
            const HalfFloats size = hn::Max(hn::Abs(direction[axis]), hn::Set(df, 0x1p-100f));
            const HalfFloats inverse = hn::Div(hn::Set(df, 1), hn::CopySignToAbs(size, direction[axis]));
            const HalfFloats overlap = hn::Mul(pad, hn::Abs(inverse));
            const HalfFloats to_lo = hn::Mul(hn::Sub(hn::Set(df, bounds_.lo[axis]), origin[axis]), inverse);
            const HalfFloats to_hi = hn::Mul(hn::Sub(hn::Set(df, bounds_.hi[axis]), origin[axis]), inverse);
            // Comparisons, because they leave begin and end alone where infinite bounds make a NaN.
            const HalfFloats enter = hn::Sub(hn::Min(to_lo, to_hi), overlap),
                             leave = hn::Add(hn::Max(to_lo, to_hi), overlap);
            begin = hn::IfThenElse(hn::Gt(enter, begin), enter, begin);
            end = hn::IfThenElse(hn::Lt(leave, end), leave, end);
            hn::StoreU(origin[axis], df, block.origin[axis] + i);
            hn::StoreU(inverse, df, block.inverse[axis] + i);
        }
        hn::StoreU(hn::IfThenElse(usable, begin, hn::Set(df, 1)), df, block.begin + i);
        // What has left the bounds before any float is not closed: it may meet what stands apart.
        const HalfFloats last = hn::Max(end, hn::Set(df, std::numeric_limits<float>::lowest()));
        hn::StoreU(hn::IfThenElseZero(usable, last), df, block.end + i);
        hn::StoreU(pad, df, block.pad + i);
        hn::StoreU(scale, df, block.t_scale + i);
    }

    HWY_INLINE void write_depth_pad(RayBlock& block, std::size_t i, const DoubleVec3& d) const {
        const DoubleTag dd;
        const HalfFloatTag df;
        const Doubles depth = hn::Max(hn::Abs(d.x), hn::Max(hn::Abs(d.y), hn::Abs(d.z)));
        const HalfFloats least =
            hn::DemoteTo(df, hn::Mul(hn::Set(dd, double{kLeastDepthPad}), hn::Max(hn::Set(dd, 1), depth)));
        hn::StoreU(to_local_ ? hn::LoadU(df, block.pad + i) : least, df, block.depth_pad + i);
    }

    const Ray* rays_;
    const Hit* hits_;
    const AffineD* to_local_;
    bool own_space_;  ///< Not the world, whose objects may take the ray further, to spaces of theirs.
    Bounds3 bounds_;
    float reach_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
