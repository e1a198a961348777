#pragma once

#include "core/math/bounds.h"
#include "core/math/field.h"

#include <memory>
#include <string>
#include <vector>

namespace rayuela {

/// Triangles over shared vertices. Immutable once loaded; instances share it.
struct TriangleMesh {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;          ///< Unit, one a position, or empty: then faces are flat.
    std::vector<Vec2> uvs;              ///< One a position, or empty.
    std::vector<glm::uvec3> triangles;  ///< Indices < positions.size(); degenerate triangles are allowed.
    Bounds3 bounds;                     ///< Of the positions.

    std::uint64_t memory_bytes() const {
        return positions.size() * sizeof(Vec3) + normals.size() * sizeof(Vec3) + uvs.size() * sizeof(Vec2) +
               triangles.size() * sizeof(glm::uvec3);
    }
};

/// A mesh from a file. `data` is filled when the file is read and is what decides equality.
struct Mesh {
    static constexpr std::string_view kType = "mesh", kLabel = "Mesh", kTip = "Triangles from an OBJ or PLY file.";

    std::string file;  ///< As the scene file names it (.obj, .ply).
    std::shared_ptr<const TriangleMesh> data;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.file, Field{"file", "File", "Mesh file, .obj or .ply, relative to the scene.", FieldRole::file});
    }
    bool operator==(const Mesh&) const = default;
};

}  // namespace rayuela
