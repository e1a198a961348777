#pragma once

#include "core/io/image_io.h"

#include <string>

namespace rayuela::image_formats {

/// The formats behind image_io.h, each in its own file. Bytes begin with the format's signature; causes come without the
/// file's name.
using Decoded = tl::expected<Image, std::string>;

Decoded decode_stb(std::string_view bytes, ColorDecoding decoding);  ///< PNG, JPEG.
/// What a PNG or JPEG says of itself, without the pixels.
Decoded header_stb(std::string_view bytes);
/// Whether the bytes are a PNG with all its chunks and their checksums, or a JPEG that begins and ends as one.
bool is_whole(std::string_view bytes);
Decoded decode_hdr(std::string_view bytes);
Decoded decode_exr(const std::string& bytes);
Decoded decode_pfm(std::string_view bytes);

tl::expected<std::string, std::string> encode_png(const Image& image);
tl::expected<std::string, std::string> encode_hdr(const Image& image);
tl::expected<std::string, std::string> encode_exr(const Image& image);
tl::expected<std::string, std::string> encode_pfm(const Image& image);

/// An image of that size without pixels yet, or why the size is refused. Pixels are allocated once the file has shown
/// that it holds them.
Decoded image_of_size(long long width, long long height);
/// Gives it its pixels, black and opaque.
void allocate(Image& image);

}  // namespace rayuela::image_formats
