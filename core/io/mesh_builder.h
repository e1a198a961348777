#pragma once

#include "core/io/mesh_io.h"

#include <span>
#include <string>

namespace rayuela {

/// Appends n - 2 triangles for a polygon of n >= 3 corners, in its own orientation. Convex polygons become fans, others are
/// cut ear by ear in the plane of their Newell normal; where no ear is left (it crosses itself) the rest becomes a fan.
/// Corners are indices into `positions`; each triangle is given as three places in `corners`.
void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3> positions,
                 std::vector<glm::uvec3>& triangles);

/// The last step of every mesh reader: refuses meshes without triangles and positions that are not finite, makes normals
/// unit (one that is zero or not finite becomes the normal of a face there) and drops them where all are those of the faces,
/// fills the bounds and puts many texture coordinates aside.
MeshResult finish_mesh(TriangleMesh mesh, const std::string& name, Problems* warnings);

}  // namespace rayuela
