#include "core/io/image_formats.h"

#include <bit>
#include <charconv>
#include <cstring>

namespace rayuela::image_formats {

namespace {

/// The next blank-separated word of a header, and the single blank after it.
std::string_view next_word(std::string_view& bytes) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
    while (!bytes.empty() && is_blank(bytes.front())) bytes.remove_prefix(1);
    std::size_t length = 0;
    while (length < bytes.size() && length < 32 && !is_blank(bytes[length])) ++length;
    const std::string_view word = bytes.substr(0, length);
    bytes.remove_prefix(std::min(length + 1, bytes.size()));
    return word;
}

template <typename T>
bool parse(std::string_view word, T& value) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

Decoded decode_pfm(std::string_view bytes) {
    const std::size_t channels = next_word(bytes) == "PF" ? 3 : 1;
    int width = 0, height = 0;
    float scale = 0;
    if (!parse(next_word(bytes), width) || !parse(next_word(bytes), height) || !parse(next_word(bytes), scale) ||
        !(scale != 0)) {
        return tl::unexpected<std::string>("has a damaged PFM header");
    }
    const bool swap = (scale < 0) != (std::endian::native == std::endian::little);
    const auto pixel_count = static_cast<unsigned long long>(width) * static_cast<unsigned long long>(height);
    if (width > 0 && height > 0 && pixel_count > bytes.size() / (4 * channels)) {
        return tl::unexpected<std::string>("is truncated");
    }
    Decoded image = image_of_size(width, height);
    if (!image) return image;
    allocate(*image);
    const char* from = bytes.data();
    for (int y = height - 1; y >= 0; --y) {
        for (int x = 0; x < width; ++x) {
            Vec4& pixel = image->at(x, y);
            for (std::size_t channel = 0; channel < channels; ++channel, from += 4) {
                std::uint32_t bits;
                std::memcpy(&bits, from, 4);
                if (swap) bits = __builtin_bswap32(bits);
                pixel[static_cast<int>(channel)] = std::bit_cast<float>(bits);
            }
            if (channels == 1) pixel.y = pixel.z = pixel.x;
        }
    }
    return image;
}

tl::expected<std::string, std::string> encode_pfm(const Image& image) {
    std::string bytes = "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n" +
                        (std::endian::native == std::endian::little ? "-1.0\n" : "1.0\n");
    bytes.reserve(bytes.size() + 12 * image.pixels.size());
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x) bytes.append(reinterpret_cast<const char*>(&image.at(x, y)), 12);
    }
    return bytes;
}

}  // namespace rayuela::image_formats
