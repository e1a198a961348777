#include "core/lights/light_importance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/lights/light_importance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, kClusters>;
using Floats = hn::Vec<FloatTag>;

/// In [0, pi].
struct Angle {
    Floats cosine, sine;
};

HWY_ATTR Floats dot(Floats ax, Floats ay, Floats az, Floats bx, Floats by, Floats bz) {
    return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

HWY_ATTR Angle from_cosine(Floats cosine) {
    const FloatTag d;
    return {cosine, hn::Sqrt(hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), hn::Mul(cosine, cosine))))};
}

/// max(0, a - b).
HWY_ATTR Angle difference(const Angle& a, const Angle& b) {
    const FloatTag d;
    const auto positive = hn::Le(a.cosine, b.cosine);
    return {hn::IfThenElse(positive, hn::Add(hn::Mul(a.cosine, b.cosine), hn::Mul(a.sine, b.sine)), hn::Set(d, 1)),
            hn::IfThenElseZero(positive, hn::Sub(hn::Mul(a.sine, b.cosine), hn::Mul(a.cosine, b.sine)))};
}

/// The same on every instruction set: no operation here rounds differently.
HWY_ATTR void importance(const LightReceiver& receiver, const LightClusters& clusters, float* result) {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> bits;
    const bool facing = receiver.n != Vec3(0);
    for (std::size_t lane = 0; lane < kClusters; lane += hn::Lanes(d)) {
        const auto load = [&](const auto& values) HWY_ATTR { return hn::LoadU(d, values.data() + lane); };
        const Floats x = hn::Sub(hn::Set(d, receiver.p.x), load(clusters.center[0]));
        const Floats y = hn::Sub(hn::Set(d, receiver.p.y), load(clusters.center[1]));
        const Floats z = hn::Sub(hn::Set(d, receiver.p.z), load(clusters.center[2]));
        const Floats radius2 = load(clusters.radius2), distance2 = dot(x, y, z, x, y, z);
        const auto outside = hn::Gt(distance2, radius2);
        const Floats reach2 = hn::Max(distance2, radius2);
        const Floats inverse = hn::Div(hn::Set(d, 1), hn::Sqrt(reach2));
        // Half angle of the ball as seen from the receiver; pi from within.
        const Floats sin2_ball = hn::Div(radius2, reach2);
        const Angle ball{hn::IfThenElse(outside, hn::Sqrt(hn::Sub(hn::Set(d, 1), sin2_ball)), hn::Set(d, -1)),
                         hn::IfThenElseZero(outside, hn::Sqrt(sin2_ball))};
        const Floats along_axis =
            hn::Mul(dot(x, y, z, load(clusters.axis[0]), load(clusters.axis[1]), load(clusters.axis[2])), inverse);
        const Floats sign = hn::BitCast(d, hn::LoadU(bits, clusters.two_sided.data() + lane));
        const Angle to_normals = difference(from_cosine(hn::AndNot(sign, along_axis)),
                                            {load(clusters.cos_spread), load(clusters.sin_spread)});
        const Floats cos_light = hn::Max(hn::Zero(d), difference(to_normals, ball).cosine);
        Floats sent = hn::Div(hn::Mul(load(clusters.power), cos_light), reach2);
        if (facing) {
            const Vec3 n = -receiver.n;
            const Floats along_normal =
                hn::Mul(dot(x, y, z, hn::Set(d, n.x), hn::Set(d, n.y), hn::Set(d, n.z)), inverse);
            sent = hn::Mul(sent, hn::Max(hn::Zero(d), difference(from_cosine(along_normal), ball).cosine));
        }
        hn::StoreU(sent, d, result + lane);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(importance);

LightClusters::Lanes<float> light_importance(const LightReceiver& receiver, const LightClusters& clusters) {
    LightClusters::Lanes<float> result;
    HWY_DYNAMIC_DISPATCH(importance)(receiver, clusters, result.data());
    return result;
}

}  // namespace rayuela
#endif
