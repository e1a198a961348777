#include "core/io/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)rayuela::decode_image(std::as_bytes(std::span(data, size)), "fuzz", rayuela::ColorDecoding::srgb);
    return 0;
}
