#include "core/io/image_formats.h"

#include <array>

namespace rayuela::image_formats {

namespace {

constexpr std::size_t kSlices = 8;
using CrcTables = std::array<std::array<std::uint32_t, 256>, kSlices>;

std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

/// PNG specification, annex D: of all bytes, the polynomial 0xedb88320. Table k is of a byte that k others follow, so that
/// several go at once (Kounavis and Berry 2005, slicing).
constexpr CrcTables kCrcTables = [] {
    CrcTables tables{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        std::uint32_t c = n;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ c >> 1 : c >> 1;
        tables[0][n] = c;
    }
    for (std::size_t k = 1; k < kSlices; ++k) {
        for (std::size_t n = 0; n < 256; ++n) tables[k][n] = tables[k - 1][n] >> 8 ^ tables[0][tables[k - 1][n] & 0xff];
    }
    return tables;
}();

std::uint32_t crc(std::string_view bytes) {
    std::uint32_t c = ~0u;
    std::size_t at = 0;
    for (; at + kSlices <= bytes.size(); at += kSlices) {
        std::uint32_t next = 0;
        for (std::size_t k = 0; k < kSlices; ++k) {
            const std::uint32_t carried = k < 4 ? c >> 8 * k : 0;
            next ^= kCrcTables[kSlices - 1 - k][(carried ^ static_cast<unsigned char>(bytes[at + k])) & 0xff];
        }
        c = next;
    }
    for (; at < bytes.size(); ++at) c = kCrcTables[0][(c ^ static_cast<unsigned char>(bytes[at])) & 0xff] ^ c >> 8;
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
