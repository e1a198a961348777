#pragma once

#include "core/math/ray.h"
#include "core/scene/scene.h"

#include <optional>
#include <span>

namespace rayuela {

/// A camera in the world. In double: through a long lens the pixels are not much farther apart than floats.
struct CameraModel {
    Vec3d origin{0}, right{0}, up{0};     ///< The middle of the lens; unit axes.
    Vec3d corner{0}, across{0}, down{0};  ///< Image plane at distance 1, relative to the origin.
    double lens_radius = 0, focus_distance = 1;
};

/// A Camera made ready: maps positions of the image and of the lens to rays.
class CameraRays {
public:
    /// `aspect` is width / height of the image plane. Directions that do not span a frame (target at the position, up
    /// along the view) are replaced by some that do.
    CameraRays(const Camera& camera, double aspect);

    /// Through `position` of the image, (0, 0) its upper left and (1, 1) its lower right corner, from the point `lens` of
    /// the unit disc. The direction is unit.
    Ray ray(const Vec2& position, const Vec2& lens) const;
    /// The same of many, one a position. `lens` may be empty where the lens has no extent.
    void rays(std::span<const Vec2> positions, std::span<const Vec2> lens, std::span<Ray> rays) const;
    /// A point as the camera sees it.
    struct View {
        Vec3 origin{0};    ///< Of the ray, on the lens.
        Vec2 position{0};  ///< Of the image; may lie outside.
    };
    /// The ray from the point `lens` of the unit disc that meets `p`; nothing behind the camera.
    std::optional<View> view(const Vec3& p, const Vec2& lens) const;
    /// Of positions evenly spread over the image, the density per solid angle of rays in this unit direction.
    float density(const Vec3& direction) const;
    /// Unit view axis.
    const Vec3& forward() const { return forward_; }

private:
    CameraModel model_;
    Vec3 forward_;
};

/// Importance sampling of the pixel filter: the offset from the pixel's centre, in pixels, for `u` in [0, 1)^2. All samples
/// weigh the same (Ernst, Stamminger & Greiner, "Filter Importance Sampling", 2006).
/// box: 1 pixel wide. tent: 2 pixels wide. gaussian: standard deviation 1/2, cut at a radius of 3/2.
Vec2 sample_filter(PixelFilter filter, const Vec2& u);
/// Density with which `sample_filter` draws the offset, and the largest component of an offset.
float filter_density(PixelFilter filter, const Vec2& offset);
float filter_radius(PixelFilter filter);

}  // namespace rayuela
