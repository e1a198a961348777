#include "core/lights/environment_light.h"

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

/// Bilinear, repeating across the seam and clamped at the poles. `position` in [0, 1]; NaN gives NaN.
Color look_up(const Image& image, const Vec2& position) {
    if (!(position.x >= 0 && position.y >= 0)) return Color(NAN);
    const float x = position.x * static_cast<float>(image.width) - 0.5f;
    const float y = position.y * static_cast<float>(image.height) - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    const auto column = [&](float c) {
        const int i = static_cast<int>(c);
        return i < 0 ? image.width - 1 : i >= image.width ? 0 : i;
    };
    const auto row = [&](float r) { return std::clamp(static_cast<int>(r), 0, image.height - 1); };
    const int x0 = column(left), x1 = column(left + 1), y0 = row(top), y1 = row(top + 1);
    return Color(glm::mix(glm::mix(image.at(x0, y0), image.at(x1, y0), x - left),
                          glm::mix(image.at(x0, y1), image.at(x1, y1), x - left), y - top));
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Environment& environment) {
    if (const auto* constant = std::get_if<ConstantEnvironment>(&environment)) {
        bottom_ = top_ = constant->radiance;
    } else if (const auto* gradient = std::get_if<GradientEnvironment>(&environment)) {
        bottom_ = gradient->bottom;
        top_ = gradient->top;
    } else if (const auto* panorama = std::get_if<ImageEnvironment>(&environment)) {
        const bool shines = panorama->image && !panorama->image->pixels.empty() && panorama->scale > 0;
        if (shines) image_ = panorama->image;
        scale_ = panorama->scale;
        const float angle = glm::radians(panorama->rotation);
        cos_rotation_ = std::cos(angle);
        sin_rotation_ = std::sin(angle);
    }
}

Color EnvironmentLight::radiance(const Vec3& w) const {
    if (image_) return scale_ * look_up(*image_, image_position(w));
    return glm::mix(bottom_, top_, 0.5f * (w.y + 1));
}

Vec2 EnvironmentLight::image_position(const Vec3& w) const {
    const float x = cos_rotation_ * w.x - sin_rotation_ * w.z;
    const float z = sin_rotation_ * w.x + cos_rotation_ * w.z;
    // atan2 of the horizontal length keeps its precision at the poles, where acos has none.
    return {glm::clamp(0.5f + std::atan2(x, -z) * (0.5f * kInvPi), 0.0f, 1.0f),
            std::atan2(std::hypot(x, z), w.y) * kInvPi};
}

Vec3 EnvironmentLight::direction(const Vec2& image_position) const {
    const float azimuth = (image_position.x - 0.5f) * (2 * kPi), polar = image_position.y * kPi;
    const float x = std::sin(polar) * std::sin(azimuth), z = -std::sin(polar) * std::cos(azimuth);
    return {cos_rotation_ * x + sin_rotation_ * z, std::cos(polar), cos_rotation_ * z - sin_rotation_ * x};
}

}  // namespace rayuela
