#include "core/io/gltf_reader.h"
#include "tests/fuzz/build_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace rayuela;
    const auto file = parse_gltf(std::as_bytes(std::span(data, size)), "/nowhere/fuzz.glb");
    if (!file) return 0;
    LoadedObject loaded;
    loaded.object.shape = Gltf{"/nowhere/fuzz.glb", (*file)->geometry, {}};
    loaded.materials = (*file)->materials;
    const auto scene = add_to_scene(Scene{}, loaded);
    if (!scene) std::abort();
    build_and_trace(*scene);
    return 0;
}
