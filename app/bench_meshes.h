#pragma once

#include "core/shapes/mesh.h"

#include <functional>
#include <string>
#include <vector>

namespace rayuela {

/// A mesh to measure with, and from where it is looked at and lit.
struct BenchMesh {
    std::string name, description;
    std::function<std::shared_ptr<const TriangleMesh>()> make;
    Vec3 eye, target;
    float field_of_view;  ///< Vertical, in degrees.
    Vec3 light_corner, light_u, light_v;
    Vec3 up{0, 1, 0};
};

/// From easy to hard: a closed room, a hall of slivers, open land twice.
std::vector<BenchMesh> bench_meshes();
/// Open land of about so many triangles.
BenchMesh bench_land(std::string name, std::size_t triangles);

}  // namespace rayuela
