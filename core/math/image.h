#pragma once

#include "core/math/vec.h"

#include <string>
#include <vector>

namespace rayuela {

/// Linear RGBA float pixels, row-major, first row at the top. Textures, environments and renders alike.
struct Image {
    int width = 0, height = 0;
    std::vector<Vec4> pixels;
    std::string source;  ///< File it came from ("helmet.glb#2" for an embedded one), as a scene file names it.

    const Vec4& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    Vec4& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

}  // namespace rayuela
