#pragma once

#include "app/bench_meshes.h"
#include "core/accel/accelerator.h"
#include "core/math/result.h"

#include <filesystem>
#include <span>

namespace rayuela {

/// What is made of triangles, as one mesh in the world.
struct WorldTriangles {
    std::shared_ptr<const TriangleMesh> mesh;
    std::size_t left_out = 0;  ///< Spheres and planes.
};

/// Meshes with their triangles, triangles, quads and boxes.
WorldTriangles world_triangles(std::span<const GeometryInstance> instances);

/// The triangles of a scene or mesh file (`read_scene`), seen from its camera and lit from above. An error where there are
/// none.
Result<BenchMesh> read_bench_mesh(const std::filesystem::path& file);

}  // namespace rayuela
