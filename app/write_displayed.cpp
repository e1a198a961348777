#include "app/write_displayed.h"

#include "core/io/image_io.h"
#include "core/math/srgb.h"

namespace rayuela {

Result<void> write_displayed(const std::filesystem::path& file, Image image) {
    for (Vec4& pixel : image.pixels) {
        for (int channel = 0; channel < 3; ++channel) pixel[channel] = srgb_to_linear(pixel[channel]);
    }
    return write_image(file, image);
}

}  // namespace rayuela
