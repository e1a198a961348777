#include "assets/generators/dragon.h"
#include "assets/generators/mesh_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <string_view>

/// gen_dragon FILE.ply [TRIANGLES]: writes the dragon with at least so many triangles (10,000 to 6,000,000).
int main(int argc, char** argv) {
    using namespace rayuela;
    constexpr std::size_t kFewest = 10'000, kMost = 6'000'000;
    std::size_t triangles = 1'000'000;
    bool understood = argc == 2 || argc == 3;
    if (argc == 3) {
        const std::string_view text = argv[2];
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), triangles);
        understood =
            error == std::errc() && end == text.data() + text.size() && triangles >= kFewest && triangles <= kMost;
    }
    if (!understood) {
        fmt::print(stderr, "usage: {} FILE.ply [TRIANGLES from {} to {}]\n", argv[0], kFewest, kMost);
        return 2;
    }
    const TriangleMesh mesh = assets::make_dragon(triangles);
    if (!assets::write_file(argv[1],
                            assets::to_ply(mesh, "Dragon of Rayuela, written by assets/generators/dragon.cpp"))) {
        fmt::print(stderr, "{}: cannot be written\n", argv[1]);
        return 1;
    }
    fmt::print("{}: {} triangles\n", argv[1], mesh.triangles.size());
    return 0;
}
