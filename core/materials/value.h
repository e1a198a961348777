#pragma once

#include "core/math/image.h"

#include <memory>

namespace rayuela {

/// A colour that may vary over a surface: value, times the texture where there is one (decoded to linear).
struct ColorValue {
    Color value{1};
    std::shared_ptr<const Image> texture;

    bool operator==(const ColorValue&) const = default;
};

/// A number that may vary over a surface: value, times one channel of the texture where there is one (linear data).
struct FloatValue {
    float value = 1;
    std::shared_ptr<const Image> texture;
    int channel = 0;  ///< 0..3: r, g, b, a.

    bool operator==(const FloatValue&) const = default;
};

/// The light a material gives off: strength times the colour, from its front and, where two-sided, from its back. A
/// material that has one can be put out: then all that this says of how much light it is, but for the texture, is 0.
struct Emission {
    const ColorValue& color;
    float strength = 1;
    bool two_sided = false;
};

/// Bilinear look-up with repeat in both axes; uv (0, 0) is the image's lower left corner.
Vec4 sample_texture(const Image& image, const Vec2& uv);

inline Color evaluate(const ColorValue& color, const Vec2& uv) {
    return color.texture ? color.value * Color(sample_texture(*color.texture, uv)) : color.value;
}

inline float evaluate(const FloatValue& number, const Vec2& uv) {
    return number.texture ? number.value * sample_texture(*number.texture, uv)[number.channel] : number.value;
}

}  // namespace rayuela
