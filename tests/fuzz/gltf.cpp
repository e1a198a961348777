#include "tests/support/show_scene.h"

#include <cstdlib>
#include <span>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace rayuela;
    const auto file = parse_gltf(std::as_bytes(std::span(data, size)), "/nowhere/fuzz.glb");
    if (file && !testing::can_be_shown(**file)) std::abort();
    return 0;
}
