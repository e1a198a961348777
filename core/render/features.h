#pragma once

namespace rayuela {

/// What a scene contains, as far as it decides which stages run. Derived from content, never set by hand; whatever covers
/// a scene gives the same image.
struct Features {
    bool emitters = false;         ///< A surface emits.
    bool environment = false;      ///< Light comes from outside.
    bool lights = false;           ///< The light table has something to sample.
    bool smooth_surfaces = false;  ///< A surface has a lobe that light samples can reach.
    bool textures = false;         ///< A material varies over its surface.
    bool lens = false;             ///< Depth of field.

    /// Whether there are light samples and shadow rays.
    bool light_sampling() const { return lights && smooth_surfaces; }
    /// Whether anything can be other than black.
    bool any_light() const { return emitters || environment; }
    bool operator==(const Features&) const = default;
};

}  // namespace rayuela
