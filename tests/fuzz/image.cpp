#include "core/io/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    (void)rayuela::decode_image(bytes, "fuzz", rayuela::ColorDecoding::srgb);
    if (const auto opened = rayuela::open_image(bytes, "fuzz", rayuela::ColorDecoding::srgb))
        (void)rayuela::with_pixels(*opened);
    return 0;
}
