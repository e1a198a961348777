#include "core/io/image_formats.h"
#include "core/math/srgb.h"

#include <stb_image.h>
#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>

namespace rayuela::image_formats {

namespace {

struct StbFree {
    void operator()(void* memory) const { stbi_image_free(memory); }
};
template <typename T>
using StbPixels = std::unique_ptr<T, StbFree>;

/// r, g, b through `color`, alpha divided by `max`.
template <typename T, typename Color8>
void convert(const T* from, std::vector<Vec4>& to, float max, const Color8& color) {
    for (Vec4& pixel : to) {
        pixel = Vec4(color(from[0]), color(from[1]), color(from[2]), static_cast<float>(from[3]) / max);
        from += 4;
    }
}

template <typename Pixels>
bool failed(const Pixels& pixels, const Image& image, int width, int height) {
    return !pixels || width != image.width || height != image.height;
}

tl::unexpected<std::string> failure() {
    const char* reason = stbi_failure_reason();
    return tl::unexpected("cannot be decoded: " + std::string(reason ? reason : "damaged"));
}

void append(void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

}  // namespace

Decoded header_stb(std::string_view bytes) {
    if (bytes.size() > INT_MAX) return tl::unexpected<std::string>("is larger than 2 GiB");
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(data, static_cast<int>(bytes.size()), &width, &height, &channels)) return failure();
    return image_of_size(width, height);
}

Decoded decode_stb(std::string_view bytes, ColorDecoding decoding) {
    Decoded image = header_stb(bytes);
    if (!image) return image;
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (stbi_is_16_bit_from_memory(data, size)) {
        const StbPixels<stbi_us> pixels(stbi_load_16_from_memory(data, size, &width, &height, &channels, 4));
        if (failed(pixels, *image, width, height)) return failure();
        allocate(*image);
        convert(pixels.get(), image->pixels, 65535, [&](stbi_us value) {
            const float unit = static_cast<float>(value) / 65535;
            return decoding == ColorDecoding::srgb ? srgb_to_linear(unit) : unit;
        });
    } else {
        const StbPixels<stbi_uc> pixels(stbi_load_from_memory(data, size, &width, &height, &channels, 4));
        if (failed(pixels, *image, width, height)) return failure();
        allocate(*image);
        std::array<float, 256> table;
        for (std::size_t i = 0; i < table.size(); ++i) {
            const float unit = static_cast<float>(i) / 255;
            table[i] = decoding == ColorDecoding::srgb ? srgb_to_linear(unit) : unit;
        }
        convert(pixels.get(), image->pixels, 255, [&](stbi_uc value) { return table[value]; });
    }
    return image;
}

tl::expected<std::string, std::string> encode_png(const Image& image) {
    std::vector<stbi_uc> pixels;
    pixels.reserve(image.pixels.size() * 3);
    for (const Vec4& pixel : image.pixels) {
        for (int channel = 0; channel < 3; ++channel) {
            const float linear = pixel[channel] > 0 ? std::min(pixel[channel], 1.0f) : 0;  // NaN becomes 0.
            pixels.push_back(static_cast<stbi_uc>(255 * linear_to_srgb(linear) + 0.5f));
        }
    }
    std::string bytes;
    if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, pixels.data(), 3 * image.width)) {
        return tl::unexpected<std::string>("PNG encoding failed");
    }
    return bytes;
}

tl::expected<std::string, std::string> encode_hdr(const Image& image) {
    std::string bytes;
    if (!stbi_write_hdr_to_func(append, &bytes, image.width, image.height, 4, &image.pixels.front().x)) {
        return tl::unexpected<std::string>("HDR encoding failed");
    }
    return bytes;
}

}  // namespace rayuela::image_formats
