#include "ui/image_view.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// The same view with `fit` written out as a zoom.
ViewSettings explicit_zoom(const ViewSettings& view, const Vec2& viewport, const Vec2& image) {
    if (!view.fit) return view;
    ViewSettings result = view;
    result.fit = false;
    result.zoom = image_view(view, viewport, image).zoom;
    result.pan_x = result.pan_y = 0;
    return result;
}

}  // namespace

ImageView image_view(const ViewSettings& view, const Vec2& viewport, const Vec2& image) {
    if (!(image.x > 0 && image.y > 0)) return {};
    const float fitting = std::min(viewport.x / image.x, viewport.y / image.y);
    const float zoom = view.fit ? std::max(fitting, 1e-3f) : view.zoom;
    const Vec2 pan = view.fit ? Vec2(0) : Vec2(view.pan_x, view.pan_y);
    const Vec2 origin = 0.5f * viewport + (pan - 0.5f * image) * zoom;
    return {glm::round(origin), zoom};
}

ViewSettings zoomed_at(const ViewSettings& view, const Vec2& viewport, const Vec2& image, const Vec2& position,
                       float factor) {
    const ViewSettings before = explicit_zoom(view, viewport, image);
    ViewSettings result = before;
    // From the pan rather than the image's rounded place, so that many small steps do not add up roundings.
    const Vec2 from_middle = position - 0.5f * viewport;
    const Vec2 pixel = from_middle / before.zoom - Vec2(before.pan_x, before.pan_y);
    result.zoom = std::clamp(result.zoom * factor, kMinZoom, kMaxZoom);
    // What comes near a whole zoom lands on it: there pixels are sharp.
    const float whole = std::round(result.zoom), away = std::abs(result.zoom - whole);
    const bool approaching = away < std::abs(before.zoom - whole);
    if (whole >= 1 && approaching && away < 0.04f * whole) result.zoom = whole;
    const Vec2 pan = from_middle / result.zoom - pixel;
    result.pan_x = pan.x;
    result.pan_y = pan.y;
    return result;
}

ViewSettings panned(const ViewSettings& view, const Vec2& viewport, const Vec2& image, const Vec2& delta) {
    ViewSettings result = explicit_zoom(view, viewport, image);
    result.pan_x += delta.x / result.zoom;
    result.pan_y += delta.y / result.zoom;
    return result;
}

}  // namespace rayuela
