#include "core/render/accumulation.h"

#include <algorithm>

namespace rayuela {

std::vector<RejectedPixel> Accumulation::rejected_pixels() const {
    std::vector<RejectedPixel> found;
    for (const Tile& tile : tiles_) {
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1 && tile.samples > 0; ++x) {
                const auto pixel = static_cast<std::uint32_t>(y * film_.width() + x);
                const std::uint64_t missing = static_cast<std::uint64_t>(tile.samples) - film_.count(pixel);
                if (missing > 0) found.push_back({pixel, static_cast<std::uint32_t>(missing)});
            }
        }
    }
    std::ranges::sort(found, {}, &RejectedPixel::pixel);
    return found;
}

}  // namespace rayuela
