#include "assets/generators/duck.h"
#include "assets/generators/mesh_file.h"

#include <fmt/format.h>

#include <cstdio>

/// gen_duck FOLDER: writes duck_body.obj and duck_bill.obj.
int main(int argc, char** argv) {
    using namespace rayuela::assets;
    if (argc != 2) {
        fmt::print(stderr, "usage: {} FOLDER\n", argv[0]);
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    for (const auto& [name, mesh] :
         {std::pair{"duck_body.obj", make_duck_body()}, {"duck_bill.obj", make_duck_bill()}}) {
        if (!write_file(folder / name, to_obj(mesh, kDuckComment))) {
            fmt::print(stderr, "{}: cannot be written\n", (folder / name).string());
            return 1;
        }
        fmt::print("{}: {} triangles\n", (folder / name).string(), mesh.triangles.size());
    }
    return 0;
}
