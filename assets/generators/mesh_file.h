#pragma once

#include "core/shapes/mesh.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

namespace rayuela::assets {

/// Wavefront OBJ with a normal a vertex; five decimals, so that the text is the same everywhere.
inline std::string to_obj(const TriangleMesh& mesh, std::string_view comment) {
    std::string text = fmt::format("# {}\n", comment);
    const auto out = std::back_inserter(text);
    for (const Vec3& p : mesh.positions) fmt::format_to(out, "v {:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
    for (const Vec3& n : mesh.normals) fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    for (const glm::uvec3& t : mesh.triangles) {
        fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", t.x + 1, t.y + 1, t.z + 1);
    }
    return text;
}

/// Binary little-endian PLY with normals.
inline std::string to_ply(const TriangleMesh& mesh, std::string_view comment) {
    std::string text = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment {}\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        comment, mesh.positions.size(), mesh.triangles.size());
    const std::size_t header = text.size();
    constexpr std::size_t kVertexBytes = 6 * sizeof(float), kFaceBytes = 1 + 3 * sizeof(std::uint32_t);
    text.resize(header + mesh.positions.size() * kVertexBytes + mesh.triangles.size() * kFaceBytes);
    char* out = text.data() + header;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i, out += kVertexBytes) {
        std::memcpy(out, &mesh.positions[i], sizeof(Vec3));
        std::memcpy(out + sizeof(Vec3), &mesh.normals[i], sizeof(Vec3));
    }
    for (const glm::uvec3& triangle : mesh.triangles) {
        *out = 3;
        std::memcpy(out + 1, &triangle, sizeof triangle);
        out += kFaceBytes;
    }
    return text;
}

/// Writes the file whole or not at all, making its folder; false when that fails.
inline bool write_file(const std::filesystem::path& path, std::string_view bytes) {
    std::error_code error;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
    std::filesystem::path partial = path;
    partial += ".part";
    {
        std::ofstream file(partial, std::ios::binary);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        if (!file.flush()) return false;
    }
    std::filesystem::rename(partial, path, error);
    return !error;
}

}  // namespace rayuela::assets
