// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_LIGHTS_LIGHT_IMPORTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_LIGHTS_LIGHT_IMPORTANCE_INL_H_
#undef RAYUELA_CORE_LIGHTS_LIGHT_IMPORTANCE_INL_H_
#else
#define RAYUELA_CORE_LIGHTS_LIGHT_IMPORTANCE_INL_H_
#endif

#include "core/math/vec_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// In [0, pi].
struct Angle {
    Floats cosine, sine;
};

HWY_INLINE Angle from_cosine(Floats cosine) {
    return {cosine, hn::Sqrt(hn::Max(hn::Zero(FloatTag()), all_lanes(1.0f) - cosine * cosine))};
}

/// max(0, a - b).
HWY_INLINE Angle difference(const Angle& a, const Angle& b) {
    const FloatMask positive = hn::Le(a.cosine, b.cosine);
    return {hn::IfThenElse(positive, a.cosine * b.cosine + a.sine * b.sine, all_lanes(1.0f)),
            hn::IfThenElseZero(positive, a.sine * b.cosine - a.cosine * b.sine)};
}

/// A group of lights a lane, or one in all lanes: see LightClusters.
struct ClusterLanes {
    Vec3Lanes center, axis;
    Floats radius2, cos_spread, sin_spread, power, two_sided;
};

/// The light that receivers at `p`, facing `n` unless that is null, are estimated to get from each group. The same on every
/// instruction set: no operation here rounds differently.
HWY_INLINE Floats importance(const Vec3Lanes& p, const Vec3Lanes* n, FloatMask facing, const ClusterLanes& cluster) {
    const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
    const Vec3Lanes from = p - cluster.center;
    const Floats distance2 = dot(from, from);
    const FloatMask outside = hn::Gt(distance2, cluster.radius2);
    const Floats reach2 = hn::Max(distance2, cluster.radius2);
    const Floats inverse = one / hn::Sqrt(reach2);
    // Half angle of the ball as seen from the receiver; pi from within.
    const Floats sin2_ball = cluster.radius2 / reach2;
    const Angle ball{hn::IfThenElse(outside, hn::Sqrt(one - sin2_ball), hn::Neg(one)),
                     hn::IfThenElseZero(outside, hn::Sqrt(sin2_ball))};
    const Floats along_axis = dot(from, cluster.axis) * inverse;
    const Angle to_normals =
        difference(from_cosine(hn::AndNot(cluster.two_sided, along_axis)), {cluster.cos_spread, cluster.sin_spread});
    const Floats cos_light = hn::Max(zero, difference(to_normals, ball).cosine);
    const Floats sent = cluster.power * cos_light / reach2;
    if (!n) return sent;
    const Floats along_normal = dot(from, -*n) * inverse;
    const Floats arriving = sent * hn::Max(zero, difference(from_cosine(along_normal), ball).cosine);
    return hn::IfThenElse(facing, arriving, sent);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
