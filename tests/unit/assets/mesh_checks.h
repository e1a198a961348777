#pragma once

#include "core/shapes/mesh.h"

#include <cstdint>
#include <map>
#include <utility>

namespace rayuela {

/// Whether every edge is shared by exactly two triangles that run along it in opposite directions.
inline bool is_closed_and_oriented(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const auto [edge, is_new] = edges.try_emplace({t[i], t[(i + 1) % 3]}, 1);
            if (!is_new || t[i] == t[(i + 1) % 3]) return false;
        }
    }
    for (const auto& [edge, count] : edges) {
        if (!edges.contains({edge.second, edge.first})) return false;
    }
    return !edges.empty();
}

/// By the divergence theorem; positive where the faces look outward.
inline double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::dot(a, glm::cross(b, c));
    }
    return sum / 6;
}

/// V - E + F of a closed mesh: twice the number of its parts where none has a handle.
inline std::int64_t euler_characteristic(const TriangleMesh& mesh) {
    const auto faces = static_cast<std::int64_t>(mesh.triangles.size());
    return static_cast<std::int64_t>(mesh.positions.size()) - faces / 2;
}

/// Largest angle between a vertex normal and a face at that vertex, as the smallest cosine.
inline double worst_normal_cosine(const TriangleMesh& mesh) {
    double worst = 1;
    for (const glm::uvec3& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const Vec3d face = glm::normalize(glm::cross(b - a, c - a));
        for (int i = 0; i < 3; ++i) worst = glm::min(worst, glm::dot(face, Vec3d(mesh.normals[t[i]])));
    }
    return worst;
}

}  // namespace rayuela
