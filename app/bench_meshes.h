#pragma once

#include "core/shapes/mesh.h"

#include <string_view>
#include <vector>

namespace rayuela {

/// A mesh to measure with, and from where it is looked at and lit.
struct BenchMesh {
    std::string_view name, description;
    std::shared_ptr<const TriangleMesh> (*make)();
    Vec3 eye, target;
    float field_of_view;  ///< Vertical, in degrees.
    Vec3 light_corner, light_u, light_v;
};

/// From easy to hard: a closed room, a hall of slivers, open land twice.
std::vector<BenchMesh> bench_meshes();

}  // namespace rayuela
