#pragma once

#include "core/math/lazy.h"
#include "core/math/vec.h"

#include <string>
#include <vector>

namespace rayuela {

/// Linear RGBA float pixels, row-major, first row at the top. Textures, environments and renders alike.
struct Image {
    int width = 0, height = 0;
    std::vector<Vec4> pixels;  ///< None where the image is `encoded`.
    std::string source;        ///< File it came from ("helmet.glb#2" for an embedded one), as a scene file names it.
    /// The image with its pixels; null where they are here. Read through `with_pixels`.
    std::shared_ptr<const Lazy<Image>> encoded = nullptr;

    const Vec4& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    Vec4& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

/// The image with its pixels: itself, or what it decodes to. Null where it does not decode, though it looked like it.
inline std::shared_ptr<const Image> with_pixels(const std::shared_ptr<const Image>& image) {
    return image && image->encoded ? image->encoded->get() : image;
}

}  // namespace rayuela
