#include "core/io/gltf_internal.h"
#include "core/io/mesh_builder.h"

#include <fmt/format.h>

#include <numeric>

namespace rayuela::gltf_internal {

namespace {

/// Triangles of a list, strip or fan (glTF 2.0, 3.7.2.1); in a strip every other one is turned round.
std::vector<glm::uvec3> assemble(int mode, const std::vector<std::uint32_t>& indices) {
    std::vector<glm::uvec3> triangles;
    const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    triangles.reserve(indices.size() / step);
    for (std::size_t i = 0; i + 2 < indices.size(); i += step) {
        const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
        if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            triangles.emplace_back(b, c, indices[0]);
        } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1) {
            triangles.emplace_back(a, c, b);
        } else {
            triangles.emplace_back(a, b, c);
        }
    }
    return triangles;
}

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

}  // namespace

Expected<std::shared_ptr<const TriangleMesh>> PrimitiveReader::read(const tinygltf::Primitive& primitive, int uv_set,
                                                                    const std::string& place) {
    const int mode = primitive.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
        context_.warn(place, mode < 0 || mode > TINYGLTF_MODE_TRIANGLE_FAN ? "has an unknown mode and is left out"
                                                                           : "points and lines are left out");
        return nullptr;
    }
    if (attribute(primitive, "POSITION") < 0) {
        context_.warn(place, "has no positions and is left out");
        return nullptr;
    }
    if (attribute(primitive, "COLOR_0") >= 0) context_.warn(place, "vertex colours are ignored");
    if (attribute(primitive, "JOINTS_0") >= 0) context_.warn(place, "skins are ignored: the rest pose is shown");
    if (!primitive.targets.empty()) context_.warn(place, "morph targets are ignored");

    const Key key{mode, primitive.indices, attribute(primitive, "POSITION"), attribute(primitive, "NORMAL"),
                  attribute(primitive, fmt::format("TEXCOORD_{}", uv_set))};
    if (const auto known = meshes_.find(key); known != meshes_.end()) return known->second;
    auto mesh = build(key, place);
    if (mesh) meshes_.emplace(key, *mesh);
    return mesh;
}

Expected<std::shared_ptr<const TriangleMesh>> PrimitiveReader::build(const Key& key, const std::string& place) {
    const auto [mode, index_accessor, position_accessor, normal_accessor, uv_accessor] = key;
    const auto positions = read_floats(context_.model, position_accessor, 3);
    if (!positions) return tl::unexpected(positions.error());
    const std::size_t count = positions->size() / 3;
    const auto optional_floats = [&](int accessor, int components) {
        if (accessor < 0) return std::vector<float>{};
        auto floats = read_floats(context_.model, accessor, components);
        if (floats && floats->size() == count * static_cast<std::size_t>(components)) return std::move(*floats);
        context_.warn(place, floats ? "an attribute has another number of elements than the positions and is ignored"
                                    : floats.error() + ": the attribute is ignored");
        return std::vector<float>{};
    };
    const std::vector<float> normals = optional_floats(normal_accessor, 3), uvs = optional_floats(uv_accessor, 2);

    std::vector<std::uint32_t> indices;
    if (index_accessor >= 0) {
        auto read = read_indices(context_.model, index_accessor);
        if (!read) return tl::unexpected(read.error());
        indices = std::move(*read);
        for (const std::uint32_t index : indices) {
            if (index < count) continue;
            return tl::unexpected(fmt::format("accessors[{}]: index {} is out of range, there are {} vertices",
                                              index_accessor, index, count));
        }
    } else {
        indices.resize(count);
        std::iota(indices.begin(), indices.end(), 0u);
    }
    if (count + indices.size() > elements_left_)
        return tl::unexpected<std::string>("the file describes too many triangles");
    elements_left_ -= count + indices.size();

    TriangleMesh mesh;
    mesh.triangles = assemble(mode, indices);
    if (mesh.triangles.empty()) {
        context_.warn(place, "has no triangles and is left out");
        return nullptr;
    }
    mesh.positions.reserve(count);
    mesh.normals.reserve(normals.size() / 3);
    mesh.uvs.reserve(uvs.size() / 2);
    for (std::size_t i = 0; i < count; ++i) {
        mesh.positions.emplace_back((*positions)[3 * i], (*positions)[3 * i + 1], (*positions)[3 * i + 2]);
        if (!normals.empty()) mesh.normals.emplace_back(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
        // glTF's v runs down from the upper left corner, ours up from the lower left.
        if (!uvs.empty()) mesh.uvs.emplace_back(uvs[2 * i], 1 - uvs[2 * i + 1]);
    }
    Problems warnings;
    MeshResult finished = finish_mesh(std::move(mesh), context_.path.string(), &warnings);
    if (!finished) return tl::unexpected(finished.error().front().place + " " + finished.error().front().cause);
    for (const Problem& warning : warnings) context_.warn(place + ": " + warning.place, warning.cause);
    return *finished;
}

}  // namespace rayuela::gltf_internal
