#pragma once

#include "core/io/mesh_io.h"

#include <string>
#include <string_view>

namespace rayuela {

/// Wavefront OBJ: polygons triangulated, negative indices, all groups and objects in one mesh, each position / uv /
/// normal tuple one vertex. Material libraries are not read.
MeshResult read_obj(const std::filesystem::path& path, Problems* warnings = nullptr);
/// The same from memory; `name` stands in messages.
MeshResult parse_obj(std::string text, const std::string& name, Problems* warnings = nullptr);

}  // namespace rayuela
