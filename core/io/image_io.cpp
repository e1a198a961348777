#include "core/io/image_io.h"

#include "core/io/file_bytes.h"
#include "core/io/image_formats.h"

#include <array>

namespace rayuela {

namespace fs = std::filesystem;
using namespace image_formats;

namespace {

struct Writer {
    std::string_view extension;
    tl::expected<std::string, std::string> (*encode)(const Image&);
};
constexpr std::array<Writer, 4> kWriters{
    {{".png", encode_png}, {".exr", encode_exr}, {".hdr", encode_hdr}, {".pfm", encode_pfm}}};

const Writer* find_writer(const fs::path& path) {
    const std::string extension = lower_extension(path);
    for (const Writer& writer : kWriters) {
        if (writer.extension == extension) return &writer;
    }
    return nullptr;
}

Decoded decode(const std::string& bytes, ColorDecoding decoding) {
    const std::string_view view = bytes;
    if (view.starts_with("\x89PNG\r\n") || view.starts_with("\xff\xd8\xff")) return decode_stb(view, decoding);
    if (view.starts_with("#?")) return decode_hdr(view);
    if (view.starts_with("\x76\x2f\x31\x01")) return decode_exr(bytes);
    if (view.starts_with("PF") || view.starts_with("Pf")) return decode_pfm(view);
    if (view.empty()) return tl::unexpected<std::string>("is empty");
    return tl::unexpected<std::string>("is no image of a known format (.png, .jpg, .hdr, .exr, .pfm)");
}

Result<std::shared_ptr<const Image>> finish(Decoded decoded, std::string name) {
    if (!decoded) return fail(std::move(name), "", std::move(decoded.error()));
    decoded->source = std::move(name);
    return std::make_shared<const Image>(std::move(*decoded));
}

Result<std::shared_ptr<const Image>> open_bytes(std::string bytes, std::string name, ColorDecoding decoding) {
    if (!is_whole(bytes)) return finish(decode(bytes, decoding), std::move(name));
    Decoded image = header_stb(bytes);
    if (!image) return finish(std::move(image), std::move(name));
    const std::uint64_t size = bytes.size();
    auto make = [bytes = std::move(bytes), name, decoding] {
        return finish(decode(bytes, decoding), name).value_or(nullptr);
    };
    image->encoded = std::make_shared<const Lazy<Image>>(std::move(make), size);
    return finish(std::move(image), std::move(name));
}

std::string copied(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<std::shared_ptr<const Image>> read_image(const fs::path& path, ColorDecoding decoding) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return finish(decode(*bytes, decoding), path.string());
}

Result<std::shared_ptr<const Image>> decode_image(std::span<const std::byte> bytes, std::string_view name,
                                                  ColorDecoding decoding) {
    return finish(decode(copied(bytes), decoding), std::string(name));
}

Result<std::shared_ptr<const Image>> open_image(const fs::path& path, ColorDecoding decoding) {
    Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return open_bytes(std::move(*bytes), path.string(), decoding);
}

Result<std::shared_ptr<const Image>> open_image(std::span<const std::byte> bytes, std::string_view name,
                                                ColorDecoding decoding) {
    return open_bytes(copied(bytes), std::string(name), decoding);
}

Result<void> write_image(const fs::path& path, const Image& image) {
    const Writer* writer = find_writer(path);
    if (!writer) {
        std::string known;
        for (const Writer& w : kWriters) known += (known.empty() ? "" : ", ") + std::string(w.extension);
        return fail(path.string(), "",
                    "unknown image extension '" + path.extension().string() + "'; known are " + known);
    }
    if (image.width <= 0 || image.height <= 0) return fail(path.string(), "", "the image is empty");
    const auto bytes = writer->encode(image);
    if (!bytes) return fail(path.string(), "", bytes.error());
    return write_file(path, *bytes);
}

bool is_writable_image(const fs::path& path) {
    return find_writer(path) != nullptr;
}

Decoded image_formats::image_of_size(long long width, long long height) {
    if (width <= 0 || height <= 0) return tl::unexpected<std::string>("has no pixels");
    if (width > (1 << 24) || height > (1 << 24) || static_cast<std::size_t>(width * height) > kMaxImagePixels) {
        return tl::unexpected("is too large: " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
    Image image;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    return image;
}

void image_formats::allocate(Image& image) {
    image.pixels.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                        Vec4(0, 0, 0, 1));
}

}  // namespace rayuela
