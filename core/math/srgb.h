#pragma once

#include <cmath>

namespace rayuela {

/// The transfer curve of IEC 61966-2-1, from an encoded value in [0, 1] to linear light.
inline float srgb_to_linear(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// Its inverse.
inline float linear_to_srgb(float linear) {
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

}  // namespace rayuela
