#pragma once

#include "core/math/image.h"
#include "core/math/result.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

namespace rayuela {

/// What the numbers of an 8 or 16 bit file mean. Files of floats (.hdr, .exr, .pfm) are linear whatever is asked for.
enum class ColorDecoding : std::uint8_t {
    srgb,    ///< A picture: red, green and blue are made linear, alpha is kept.
    linear,  ///< Data: divided by 255 (65535).
};

/// Larger images are refused, so that a few bytes of header cannot ask for gigabytes.
inline constexpr std::size_t kMaxImagePixels = std::size_t{1} << 27;

/// Reads .png, .jpg, .hdr, .exr or .pfm; the content decides, not the extension. Missing channels: a grey image has
/// r = g = b, alpha is 1. Image::source is the path as given.
Result<std::shared_ptr<const Image>> read_image(const std::filesystem::path& path, ColorDecoding decoding);

/// The same from memory; `name` stands in messages and in Image::source.
Result<std::shared_ptr<const Image>> decode_image(std::span<const std::byte> bytes, std::string_view name,
                                                  ColorDecoding decoding);

/// The same, but the pixels of what looks like a whole PNG or JPEG are decoded when somebody asks for them (`with_pixels`);
/// until then the image keeps the bytes of the file.
Result<std::shared_ptr<const Image>> open_image(const std::filesystem::path& path, ColorDecoding decoding);
Result<std::shared_ptr<const Image>> open_image(std::span<const std::byte> bytes, std::string_view name,
                                                ColorDecoding decoding);

/// Writes r, g, b by extension: .exr, .pfm, .hdr as they are (linear floats); .png as 8 bit sRGB, so the caller has
/// applied exposure and tone map and the pixels are display-linear in [0, 1] (clipped). The file appears whole or not at all.
Result<void> write_image(const std::filesystem::path& path, const Image& image);

/// Whether `write_image` knows the extension of this path.
bool is_writable_image(const std::filesystem::path& path);

}  // namespace rayuela
