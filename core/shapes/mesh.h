#pragma once

#include "core/math/bounds.h"
#include "core/math/field.h"
#include "core/math/lazy.h"

#include <memory>
#include <string>
#include <vector>

namespace rayuela {

/// Triangles over shared vertices. Immutable once loaded; instances share it.
struct TriangleMesh {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;          ///< Unit, one a position, or empty: then faces are flat.
    std::vector<Vec2> uvs;              ///< One a position, or empty; see `uvs_of`.
    std::vector<glm::uvec3> triangles;  ///< Indices < positions.size(); degenerate triangles are allowed.
    Bounds3 bounds;                     ///< Of the positions.
    /// Instead of `uvs`: they are not in memory but while somebody reads them.
    std::shared_ptr<const Lazy<std::vector<Vec2>>> uvs_aside = nullptr;

    bool has_uvs() const { return !uvs.empty() || uvs_aside; }
    /// Of those that are not in memory now.
    std::uint64_t bytes_aside() const {
        return uvs_aside && !uvs_aside->if_made() ? positions.size() * sizeof(Vec2) : 0;
    }
    std::uint64_t memory_bytes() const {
        return positions.size() * sizeof(Vec3) + normals.size() * sizeof(Vec3) +
               (has_uvs() ? positions.size() * sizeof(Vec2) - bytes_aside() : 0) +
               triangles.size() * sizeof(glm::uvec3);
    }
};

/// One a position, in memory for as long as they are held; null where the mesh has none, or they cannot be had back.
inline std::shared_ptr<const std::vector<Vec2>> uvs_of(const std::shared_ptr<const TriangleMesh>& mesh) {
    if (mesh->uvs_aside) return mesh->uvs_aside->get();
    return mesh->uvs.empty() ? nullptr : std::shared_ptr<const std::vector<Vec2>>(mesh, &mesh->uvs);
}

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
