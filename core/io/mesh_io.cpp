#include "core/io/mesh_io.h"

#include "core/io/file_bytes.h"
#include "core/io/obj_reader.h"
#include "core/io/ply_reader.h"

#include <fmt/format.h>

#include <bit>
#include <iterator>

namespace rayuela {

namespace fs = std::filesystem;

namespace {

template <typename T>
void put(std::string& bytes, const T& value) {
    static_assert(std::endian::native == std::endian::little, "binary PLY is written in the machine's order");
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string to_ply(const TriangleMesh& mesh, const std::vector<Vec2>& uvs) {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n",
        mesh.positions.size());
    if (!mesh.normals.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!uvs.empty()) bytes += "property float u\nproperty float v\n";
    bytes +=
        fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.size());
    bytes.reserve(bytes.size() + 32 * mesh.positions.size() + 13 * mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        put(bytes, mesh.positions[i]);
        if (!mesh.normals.empty()) put(bytes, mesh.normals[i]);
        if (!uvs.empty()) put(bytes, uvs[i]);
    }
    for (const glm::uvec3& triangle : mesh.triangles) {
        put(bytes, std::uint8_t{3});
        put(bytes, triangle);
    }
    return bytes;
}

std::string to_obj(const TriangleMesh& mesh, const std::vector<Vec2>& uvs) {
    std::string text;
    const auto out = std::back_inserter(text);
    for (const Vec3& p : mesh.positions) fmt::format_to(out, "v {} {} {}\n", p.x, p.y, p.z);
    for (const Vec3& n : mesh.normals) fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);
    for (const Vec2& uv : uvs) fmt::format_to(out, "vt {} {}\n", uv.x, uv.y);
    for (const glm::uvec3& triangle : mesh.triangles) {
        text += 'f';
        for (int corner = 0; corner < 3; ++corner) {
            const auto index = triangle[corner] + 1;
            fmt::format_to(out, " {}", index);
            if (!uvs.empty()) fmt::format_to(out, "/{}", index);
            if (!mesh.normals.empty()) fmt::format_to(out, "{}/{}", uvs.empty() ? "/" : "", index);
        }
        text += '\n';
    }
    return text;
}

}  // namespace

MeshResult read_mesh(const fs::path& path, Problems* warnings) {
    const std::string extension = lower_extension(path);
    if (extension == ".obj") return read_obj(path, warnings);
    if (extension == ".ply") return read_ply(path, warnings);
    return fail(path.string(), "", "unknown mesh extension '" + extension + "'; known are .obj, .ply");
}

Result<void> write_mesh(const fs::path& path, const TriangleMesh& mesh) {
    const std::string extension = lower_extension(path);
    const auto aside = mesh.uvs_aside ? mesh.uvs_aside->get() : nullptr;
    const std::vector<Vec2>& uvs = aside ? *aside : mesh.uvs;
    if (extension == ".ply") return write_file(path, to_ply(mesh, uvs));
    if (extension == ".obj") return write_file(path, to_obj(mesh, uvs));
    return fail(path.string(), "", "unknown mesh extension '" + extension + "'; known are .obj, .ply");
}

bool is_mesh_file(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".obj" || extension == ".ply";
}

}  // namespace rayuela
