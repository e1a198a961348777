#pragma once

#include "core/scene/environment.h"

namespace rayuela {

/// The light from outside, ready to be looked up: what an Environment is to a ray that has left the scene.
class EnvironmentLight {
public:
    EnvironmentLight() = default;
    explicit EnvironmentLight(const Environment& environment);

    /// Radiance arriving from unit direction `w` (pointing away from the scene).
    Color radiance(const Vec3& w) const;
    /// Whether `radiance` is zero everywhere.
    bool is_black() const { return !image_ && rayuela::is_black(bottom_) && rayuela::is_black(top_); }

    /// Null unless the environment is an image.
    const Image* image() const { return image_.get(); }
    /// Image coordinates in [0, 1], (0, 0) the upper left corner, of a unit direction; and the reverse.
    Vec2 image_position(const Vec3& w) const;
    Vec3 direction(const Vec2& image_position) const;

private:
    Color bottom_{0}, top_{0};
    std::shared_ptr<const Image> image_;
    float scale_ = 1;
    float cos_rotation_ = 1, sin_rotation_ = 0;
};

}  // namespace rayuela
