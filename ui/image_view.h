#pragma once

#include "core/math/vec.h"
#include "ui/view_settings.h"

namespace rayuela {

/// Where the image lies in the viewport. All in the viewport's pixels, from its upper left corner.
struct ImageView {
    Vec2 origin{0};  ///< The image's upper left corner.
    float zoom = 1;  ///< Viewport pixels an image pixel.

    Vec2 to_image(const Vec2& position) const { return (position - origin) / zoom; }
    Vec2 to_viewport(const Vec2& pixel) const { return origin + pixel * zoom; }
};

inline constexpr float kMinZoom = 1.0f / 16, kMaxZoom = 128;

/// At integer zooms pixels of image and viewport coincide.
ImageView image_view(const ViewSettings& view, const Vec2& viewport, const Vec2& image);

/// Zooms by `factor` around a position of the viewport, which keeps its place in the image.
ViewSettings zoomed_at(const ViewSettings& view, const Vec2& viewport, const Vec2& image, const Vec2& position,
                       float factor);

/// Moves the image by `delta` viewport pixels.
ViewSettings panned(const ViewSettings& view, const Vec2& viewport, const Vec2& image, const Vec2& delta);

}  // namespace rayuela
