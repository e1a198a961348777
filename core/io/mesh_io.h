#pragma once

#include "core/math/result.h"
#include "core/shapes/mesh.h"

#include <filesystem>
#include <memory>

namespace rayuela {

using MeshResult = Result<std::shared_ptr<const TriangleMesh>>;

/// Reads .obj or .ply, by extension. Positions are finite and indices in range, or it is an error that names the line or
/// element. What could be repaired (zero or non-finite normals and the like) is told in `warnings`.
MeshResult read_mesh(const std::filesystem::path& path, Problems* warnings = nullptr);

/// Writes .ply (binary, little endian) or .obj, by extension. Reading it gives the same floats.
Result<void> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

/// Whether `read_mesh` knows the extension of this path.
bool is_mesh_file(const std::filesystem::path& path);

}  // namespace rayuela
