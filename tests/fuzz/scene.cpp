#include "core/io/scene_writer.h"
#include "tests/support/show_scene.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace rayuela;
    const auto loaded = scene_from_json({reinterpret_cast<const char*>(data), size}, "/nowhere", "fuzz.scene.json");
    if (!loaded) return 0;
    if (!testing::can_be_shown(loaded->scene)) std::abort();
    const auto text = scene_to_json(loaded->scene, "/nowhere");
    if (!text) std::abort();
    const auto again = scene_from_json(*text, "/nowhere", "again.scene.json");
    if (!again || !(again->scene == loaded->scene)) std::abort();
    return 0;
}
