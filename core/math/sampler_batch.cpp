#include "core/math/sampler_batch.h"

#include <algorithm>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/math/sampler_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/math/sampler_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// take(lanes, first, n) for n samplers at a time.
template <typename Take>
HWY_INLINE void each_group(std::span<const Sampler> samplers, const Take& take) {
    alignas(64) std::uint32_t key_0[kLanes] = {}, key_1[kLanes] = {}, reversed_index[kLanes] = {};
    for (std::size_t first = 0; first < samplers.size(); first += kLanes) {
        const std::size_t n = std::min(kLanes, samplers.size() - first);
        for (std::size_t i = 0; i < n; ++i) {
            const Sampler& sampler = samplers[first + i];
            key_0[i] = sampler.key()[0];
            key_1[i] = sampler.key()[1];
            reversed_index[i] = sampler.reversed_index();
        }
        take(SamplerLanes(samplers[0].kind(), key_0, key_1, reversed_index), first, n);
    }
}

HWY_ATTR void draw_singles(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<float> numbers) {
    alignas(64) float x[kLanes];
    each_group(samplers, [&](const SamplerLanes& lanes, std::size_t first, std::size_t n) HWY_ATTR {
        hn::Store(lanes.get_1d(dimension), FloatTag(), x);
        std::copy_n(x, n, numbers.begin() + static_cast<std::ptrdiff_t>(first));
    });
}

template <typename Map>
HWY_INLINE void draw_mapped(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> numbers,
                            const Map& map) {
    alignas(64) float x[kLanes], y[kLanes];
    each_group(samplers, [&](const SamplerLanes& lanes, std::size_t first, std::size_t n) HWY_ATTR {
        const Vec2Lanes u = map(lanes.get_2d(dimension));
        hn::Store(u.x, FloatTag(), x);
        hn::Store(u.y, FloatTag(), y);
        for (std::size_t i = 0; i < n; ++i) numbers[first + i] = {x[i], y[i]};
    });
}

HWY_ATTR void draw_pairs(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> numbers) {
    draw_mapped(samplers, dimension, numbers, [](const Vec2Lanes& u) HWY_ATTR { return u; });
}

HWY_ATTR void draw_points(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> points) {
    draw_mapped(samplers, dimension, points, [](const Vec2Lanes& u) HWY_ATTR { return sample_concentric_disk(u); });
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(draw_singles);
HWY_EXPORT(draw_pairs);
HWY_EXPORT(draw_points);

void draw_1d(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<float> numbers) {
    HWY_DYNAMIC_DISPATCH(draw_singles)(samplers, dimension, numbers);
}

void draw_2d(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> numbers) {
    HWY_DYNAMIC_DISPATCH(draw_pairs)(samplers, dimension, numbers);
}

void draw_disk(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> points) {
    HWY_DYNAMIC_DISPATCH(draw_points)(samplers, dimension, points);
}

}  // namespace rayuela
#endif
