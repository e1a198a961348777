#include "core/io/ply_reader.h"
#include "tests/fuzz/build_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto mesh = rayuela::parse_ply({reinterpret_cast<const char*>(data), size}, "fuzz.ply");
    if (mesh) rayuela::build_and_trace(*mesh);
    return 0;
}
