#include "core/io/image_formats.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

// Radiance RGBE (Greg Ward, "Real Pixels", Graphics Gems II). Not left to stb_image 2.27, which never returns from a
// file that is cut off within a run.
namespace rayuela::image_formats {

namespace {

using Rgbe = std::array<unsigned char, 4>;

Vec4 to_pixel(const Rgbe& rgbe) {
    if (rgbe[3] == 0) return {0, 0, 0, 1};
    const float scale = std::ldexp(1.0f, static_cast<int>(rgbe[3]) - (128 + 8));
    return {static_cast<float>(rgbe[0]) * scale, static_cast<float>(rgbe[1]) * scale,
            static_cast<float>(rgbe[2]) * scale, 1};
}

/// Takes bytes from the front; false once there are too few.
class Bytes {
public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

    std::size_t left() const { return bytes_.size(); }

    std::optional<std::string_view> line() {
        const std::size_t end = bytes_.find('\n');
        if (end == std::string_view::npos) return std::nullopt;
        const std::string_view line = bytes_.substr(0, end);
        bytes_.remove_prefix(end + 1);
        return line;
    }
    bool take(unsigned char& byte) {
        if (bytes_.empty()) return false;
        byte = static_cast<unsigned char>(bytes_.front());
        bytes_.remove_prefix(1);
        return true;
    }
    bool take(Rgbe& rgbe) { return take(rgbe[0]) && take(rgbe[1]) && take(rgbe[2]) && take(rgbe[3]); }
    /// The four bytes that come next, left where they are.
    std::optional<Rgbe> peek() const {
        Bytes copy = *this;
        Rgbe rgbe;
        return copy.take(rgbe) ? std::optional(rgbe) : std::nullopt;
    }

private:
    std::string_view bytes_;
};

/// A row whose four channels are run-length coded one after another.
bool read_coded_row(Bytes& bytes, std::vector<Rgbe>& row) {
    for (std::size_t channel = 0; channel < 4; ++channel) {
        for (std::size_t x = 0; x < row.size();) {
            unsigned char count = 0, value = 0;
            if (!bytes.take(count)) return false;
            const bool is_run = count > 128;
            const std::size_t length = is_run ? count - 128u : count;
            if (length == 0 || length > row.size() - x || (is_run && !bytes.take(value))) return false;
            for (std::size_t i = 0; i < length; ++i) {
                if (!is_run && !bytes.take(value)) return false;
                row[x++][channel] = value;
            }
        }
    }
    return true;
}

/// A row of plain pixels; (1, 1, 1, n) repeats the last one n times, several in a row make one larger number.
bool read_plain_row(Bytes& bytes, std::vector<Rgbe>& row) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < row.size();) {
        Rgbe rgbe;
        if (!bytes.take(rgbe)) return false;
        if (rgbe[0] == 1 && rgbe[1] == 1 && rgbe[2] == 1) {
            const std::size_t length = shift < 32 ? static_cast<std::size_t>(rgbe[3]) << shift : row.size() + 1;
            if (x == 0 || length > row.size() - x) return false;
            for (std::size_t i = 0; i < length; ++i, ++x) row[x] = row[x - 1];
            shift += 8;
        } else {
            row[x++] = rgbe;
            shift = 0;
        }
    }
    return true;
}

bool read_row(Bytes& bytes, std::vector<Rgbe>& row) {
    const auto lead = bytes.peek();
    const bool is_coded = lead && (*lead)[0] == 2 && (*lead)[1] == 2 && row.size() >= 8 && row.size() < 32768 &&
                          ((*lead)[2] << 8 | (*lead)[3]) == static_cast<int>(row.size());
    if (!is_coded) return read_plain_row(bytes, row);
    Rgbe skipped;
    return bytes.take(skipped) && read_coded_row(bytes, row);
}

/// "-Y height +X width", the only orientation in use.
bool read_size(std::string_view line, int& width, int& height) {
    if (!line.starts_with("-Y ")) return false;
    const char* const last = line.data() + line.size();
    const auto [y_end, y_error] = std::from_chars(line.data() + 3, last, height);
    constexpr std::string_view kX = " +X ";
    if (y_error != std::errc() || !std::string_view(y_end, static_cast<std::size_t>(last - y_end)).starts_with(kX))
        return false;
    return std::from_chars(y_end + kX.size(), last, width).ec == std::errc();
}

}  // namespace

Decoded decode_hdr(std::string_view text) {
    Bytes bytes(text);
    for (auto line = bytes.line();; line = bytes.line()) {
        if (!line) return tl::unexpected<std::string>("has a damaged header");
        if (line->starts_with("FORMAT=") && !line->starts_with("FORMAT=32-bit_rle_rgbe")) {
            return tl::unexpected<std::string>("is a Radiance file of another format than 32-bit_rle_rgbe");
        }
        if (line->empty()) break;
    }
    int width = 0, height = 0;
    const auto line = bytes.line();
    if (!line || !read_size(*line, width, height)) return tl::unexpected<std::string>("has a damaged or turned size");
    // Every row takes at least one run of 127 pixels a channel, or one plain pixel and its repetitions.
    if (height > 0 && static_cast<std::size_t>(height) > bytes.left() / 4)
        return tl::unexpected<std::string>("is cut off");
    Decoded image = image_of_size(width, height);
    if (!image) return image;
    std::vector<Rgbe> row(static_cast<std::size_t>(width));
    for (int y = 0; y < height; ++y) {
        if (!read_row(bytes, row))
            return tl::unexpected<std::string>("is damaged or cut off in row " + std::to_string(y));
        for (const Rgbe& rgbe : row) image->pixels.push_back(to_pixel(rgbe));
    }
    return image;
}

}  // namespace rayuela::image_formats
