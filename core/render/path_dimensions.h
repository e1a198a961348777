#pragma once

#include "core/math/sampler.h"

#include <cstdint>

namespace rayuela {

/// What a dimension of the sampler decides, as numbers within a set of four: those of a set are stratified together, the
/// first two best. Set 0 is the camera's and set b + 1 that of bounce b, but light samples belong to the direction that
/// leads to them, and those of the first hit to the position in the image.
enum CameraDimension : std::uint32_t { kFilter, kFirstLight, kLens };
enum BounceDimension : std::uint32_t { kDirection, kNextLight, kLobe, kRoulette };

inline std::uint32_t dimension(int bounce, BounceDimension purpose) {
    return (static_cast<std::uint32_t>(bounce) + 1) * kSobolPairs + purpose;
}

inline std::uint32_t light_dimension(int bounce) {
    return bounce == 0 ? std::uint32_t{kFirstLight} : dimension(bounce - 1, kNextLight);
}

/// Without light samples directions take their places.
inline std::uint32_t direction_dimension(int bounce, bool light_sampling) {
    if (light_sampling) return dimension(bounce, kDirection);
    const auto ordinal = static_cast<std::uint32_t>(bounce) + 1;  // The position in the image is number 0.
    return ordinal / 2 * kSobolPairs + ordinal % 2;
}

}  // namespace rayuela
