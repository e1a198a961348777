#pragma once

#include "core/io/mesh_io.h"

#include <string>
#include <string_view>

namespace rayuela {

/// Stanford PLY, ascii or binary of either byte order: vertices (x, y, z; nx, ny, nz; u, v or s, t) and faces (polygons
/// become fans). Other elements and properties are skipped.
MeshResult read_ply(const std::filesystem::path& path, Problems* warnings = nullptr);
/// The same from memory; `name` stands in messages.
MeshResult parse_ply(std::string_view bytes, const std::string& name, Problems* warnings = nullptr);

}  // namespace rayuela
