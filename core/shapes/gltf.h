#pragma once

#include "core/math/id.h"
#include "core/math/transform.h"
#include "core/shapes/mesh.h"

namespace rayuela {

/// One primitive of one node of a glTF file, placed in the file's space.
struct GltfPart {
    std::string name;
    std::shared_ptr<const TriangleMesh> mesh;
    Affine to_file;
    std::uint32_t material = 0;  ///< Index into Gltf::materials.
};

/// What a glTF file holds besides its materials. Immutable once loaded.
struct GltfGeometry {
    std::vector<GltfPart> parts;
};

/// A glTF 2.0 file (.gltf, .glb) as one object that brings its own materials: they stand in the scene's list as
/// "<file stem>/<name>" and can be edited there. Object::material, when set, replaces them all.
struct Gltf {
    static constexpr std::string_view kType = "gltf", kLabel = "glTF", kTip = "A glTF 2.0 file with its own materials.";

    std::string file;
    std::shared_ptr<const GltfGeometry> geometry;
    std::vector<MaterialId> materials;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.file, Field{"file", "File", "glTF file, .gltf or .glb, relative to the scene.", FieldRole::file});
    }
    bool operator==(const Gltf&) const = default;
};

}  // namespace rayuela
