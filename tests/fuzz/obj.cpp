#include "core/io/obj_reader.h"
#include "tests/support/show_scene.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto mesh = rayuela::parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz.obj");
    if (mesh && !rayuela::testing::can_be_shown(*mesh)) std::abort();
    return 0;
}
