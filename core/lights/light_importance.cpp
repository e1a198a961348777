#include "core/lights/light_importance.h"

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/lights/light_importance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/lights/light_importance-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_ATTR void importance_of_all(const LightReceiver& receiver, const LightClusters& clusters, float* result) {
    const FloatTag d;
    const bool facing = receiver.n != Vec3(0);
    const Vec3Lanes p = all_lanes(receiver.p), n = all_lanes(receiver.n);
    for (std::size_t lane = 0; lane < kClusters; lane += kLanes) {
        const auto load = [&](const auto& values) HWY_ATTR { return hn::LoadU(d, values.data() + lane); };
        const auto load_3 = [&](const auto& rows) HWY_ATTR {
            return Vec3Lanes{load(rows[0]), load(rows[1]), load(rows[2])};
        };
        const Floats two_sided = hn::BitCast(d, hn::LoadU(WordTag(), clusters.two_sided.data() + lane));
        const ClusterLanes cluster{load_3(clusters.center),
                                   load_3(clusters.axis),
                                   load(clusters.radius2),
                                   load(clusters.cos_spread),
                                   load(clusters.sin_spread),
                                   load(clusters.power),
                                   two_sided};
        hn::StoreU(importance(p, facing ? &n : nullptr, hn::FirstN(d, kLanes), cluster), d, result + lane);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(importance_of_all);

LightClusters::Lanes<float> light_importance(const LightReceiver& receiver, const LightClusters& clusters) {
    LightClusters::Lanes<float> result;
    HWY_DYNAMIC_DISPATCH(importance_of_all)(receiver, clusters, result.data());
    return result;
}

}  // namespace rayuela
#endif
