#pragma once

#include "core/lights/light_importance.h"
#include "core/lights/light_sample.h"

#include <cstddef>

namespace rayuela {

/// Points that want a sample of light each, as a structure of arrays, and the samples.
struct LightBlock {
    static constexpr std::size_t kSize = 64;
    using Row = float[kSize];
    using Rows = float[3][kSize];

    std::size_t size = 0;

    // Given.
    alignas(64) Rows p, n;  ///< See LightReceiver.
    Row u, v;               ///< As LightTable::sample wants them.

    // Found, as in LightSample.
    Rows wi, target, radiance;
    Row distance;
    Row pdf;  ///< 0: no sample, and the rest says nothing.

    void put_receiver(std::size_t i, const LightReceiver& receiver);
    LightReceiver receiver(std::size_t i) const;
    void put(std::size_t i, const LightSample& sample);
    LightSample sample(std::size_t i) const;
};

inline void put(const Vec3& v, LightBlock::Rows& rows, std::size_t i) {
    for (int axis = 0; axis < 3; ++axis) rows[axis][i] = v[axis];
}
inline Vec3 vec(const LightBlock::Rows& rows, std::size_t i) {
    return {rows[0][i], rows[1][i], rows[2][i]};
}

inline void LightBlock::put_receiver(std::size_t i, const LightReceiver& receiver) {
    rayuela::put(receiver.p, p, i);
    rayuela::put(receiver.n, n, i);
}
inline LightReceiver LightBlock::receiver(std::size_t i) const {
    return {vec(p, i), vec(n, i)};
}
inline void LightBlock::put(std::size_t i, const LightSample& s) {
    rayuela::put(s.wi, wi, i);
    rayuela::put(s.target, target, i);
    rayuela::put(s.radiance, radiance, i);
    distance[i] = s.distance;
    pdf[i] = s.pdf;
}
inline LightSample LightBlock::sample(std::size_t i) const {
    return {vec(wi, i), distance[i], vec(target, i), vec(radiance, i), pdf[i]};
}

}  // namespace rayuela
