#include "ui/gl_context.h"

#include <glad/glad.h>

namespace rayuela {

Image GlContext::read_pixels() const {
    const glm::ivec2 size = framebuffer_size();
    std::vector<glm::u8vec4> bytes(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
    Image image{size.x, size.y, std::vector<Vec4>(bytes.size()), ""};
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const std::size_t flipped = static_cast<std::size_t>(size.y - 1 - y) * static_cast<std::size_t>(size.x);
            const glm::u8vec4 pixel = bytes[flipped + static_cast<std::size_t>(x)];
            image.at(x, y) = Vec4(Vec3(pixel) / 255.0f, 1);
        }
    }
    return image;
}

}  // namespace rayuela
