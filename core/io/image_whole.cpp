#include "core/io/image_formats.h"

#include <array>

namespace rayuela::image_formats {

namespace {

std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

/// PNG specification, annex D: of all bytes, the polynomial 0xedb88320.
constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < table.size(); ++n) {
        std::uint32_t c = n;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ c >> 1 : c >> 1;
        table[n] = c;
    }
    return table;
}();

std::uint32_t crc(std::string_view bytes) {
    std::uint32_t c = ~0u;
    for (const char byte : bytes) c = kCrcTable[(c ^ static_cast<unsigned char>(byte)) & 0xff] ^ c >> 8;
    return ~c;
}

/// Chunks of length, type, data and checksum up to IEND.
bool is_whole_png(std::string_view bytes) {
    constexpr std::size_t kSignature = 8, kAround = 12;
    bool data = false;
    for (std::size_t at = kSignature; at <= bytes.size() && bytes.size() - at >= kAround;) {
        const std::size_t length = big_endian(bytes, at, 4);
        if (length > bytes.size() - at - kAround) return false;
        const std::string_view chunk = bytes.substr(at + 4, length + 4);
        if (crc(chunk) != big_endian(bytes, at + 8 + length, 4)) return false;
        if (chunk.starts_with("IEND")) return data;
        data |= chunk.starts_with("IDAT");
        at += length + kAround;
    }
    return false;
}

/// Segments of marker and length up to the first scan, and the mark of the end where the file ends.
bool is_whole_jpeg(std::string_view bytes) {
    constexpr unsigned kStartOfScan = 0xffda;
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        const std::uint32_t marker = big_endian(bytes, at, 2), length = big_endian(bytes, at + 2, 2);
        if (marker >> 8 != 0xff || length < 2) return false;
        if (marker == kStartOfScan) return bytes.ends_with("\xff\xd9");
        at += 2 + length;
    }
    return false;
}

}  // namespace

bool is_whole(std::string_view bytes) {
    if (bytes.starts_with("\x89PNG\r\n")) return is_whole_png(bytes);
    return bytes.starts_with("\xff\xd8\xff") && is_whole_jpeg(bytes);
}

}  // namespace rayuela::image_formats
