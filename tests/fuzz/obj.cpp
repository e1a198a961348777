#include "core/io/obj_reader.h"
#include "tests/fuzz/build_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto mesh = rayuela::parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz.obj");
    if (mesh) rayuela::build_and_trace(*mesh);
    return 0;
}
