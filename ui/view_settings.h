#pragma once

#include <cstdint>

namespace rayuela {

enum class ToneMap : std::uint8_t { linear, aces, agx, filmic, false_color };
inline constexpr const char* kToneMapNames[] = {"Linear", "ACES", "AgX", "Filmic", "False color"};

/// What the viewport shows: the image, or a number of each pixel in false colours (see core/render/health_maps.h).
enum class ViewMap : std::uint8_t { image, samples, rejected, position_error, retrace };
struct ViewMapText {
    const char *name, *tip;
};
inline constexpr ViewMapText kViewMaps[] = {
    {"Image", "The image that is being rendered."},
    {"Samples", "How many samples each pixel has got: with adaptive sampling they go where the noise is."},
    {"Rejections", "How many samples of each pixel were left out because their value made no sense."},
    {"Position error",
     "How large the error bound of what each pixel sees is, relative to its distance from the camera."},
    {"Float vs double", "Traces the view again by other formulas in double and shows where the hits differ."},
};

enum class GizmoMode : std::uint8_t { none, translate, rotate, scale };

/// How the image is looked at. None of it is part of the scene, and none of it ever restarts accumulation.
struct ViewSettings {
    float exposure = 0;  ///< Stops: the radiance is multiplied by 2^exposure.
    ToneMap tone_map = ToneMap::linear;
    ViewMap map = ViewMap::image;
    bool fit = true;             ///< Scale the image to the viewport; else `zoom` and `pan` hold.
    float zoom = 1;              ///< Display pixels an image pixel.
    float pan_x = 0, pan_y = 0;  ///< Image pixels by which the image's centre is moved from the viewport's.
    bool show_outline = true;
    GizmoMode gizmo = GizmoMode::none;
    bool match_window = true;   ///< The film takes the size of the viewport.
    bool reset_layout = false;  ///< Set to have the panels back in their first places; the next frame clears it.
};

}  // namespace rayuela
