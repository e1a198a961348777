#include "core/materials/value.h"

#include <cmath>

namespace rayuela {
namespace {

/// Texel below `x` in [0, 1] times size - 1/2, its successor with repeat, and the way between them.
struct Neighbours {
    int below, above;
    float fraction;
};

Neighbours neighbours(float x, int size) {
    const float unit = x - std::floor(x);
    if (!(unit >= 0 && unit <= 1)) return {0, 0, 0};  // NaN and infinity
    const float position = unit * static_cast<float>(size) - 0.5f;
    const float floor = std::floor(position);
    const int below = static_cast<int>(floor);
    return {below < 0 ? size - 1 : below, below + 1 >= size ? 0 : below + 1, position - floor};
}

}  // namespace

Vec4 sample_texture(const Image& image, const Vec2& uv) {
    if (image.pixels.empty()) return Vec4(0);
    const Neighbours x = neighbours(uv.x, image.width), y = neighbours(1 - uv.y, image.height);
    return glm::mix(glm::mix(image.at(x.below, y.below), image.at(x.above, y.below), x.fraction),
                    glm::mix(image.at(x.below, y.above), image.at(x.above, y.above), x.fraction), y.fraction);
}

}  // namespace rayuela
