#pragma once

#include "tests/support/accel_scenes.h"

#include <algorithm>
#include <map>

/// Meshes without holes, around the origin, seen counter-clockwise from outside.
namespace rayuela::test {

inline MeshPtr make_tetrahedron() {
    return make_mesh({Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)},
                     {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
}

inline MeshPtr make_cube() {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    return make_mesh(corners, {{0, 2, 1},
                               {1, 2, 3},
                               {4, 5, 6},
                               {5, 7, 6},
                               {0, 1, 4},
                               {1, 5, 4},
                               {2, 6, 3},
                               {3, 6, 7},
                               {0, 4, 2},
                               {2, 4, 6},
                               {1, 3, 5},
                               {3, 7, 5}});
}

/// Icosahedron, each face in four again and again: 20 * 4^levels triangles on the unit sphere.
inline MeshPtr make_icosphere(int levels) {
    const float g = 1.618034f;
    std::vector<Vec3> positions{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& p : positions) p = glm::normalize(p);
    std::vector<glm::uvec3> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
        const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, added] =
                midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(positions.size()));
            if (added) positions.push_back(glm::normalize(positions[a] + positions[b]));
            return at->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3& t : triangles) {
            const std::uint32_t ab = midpoint(t.x, t.y), bc = midpoint(t.y, t.z), ca = midpoint(t.z, t.x);
            finer.insert(finer.end(), {{t.x, ab, ca}, {t.y, bc, ab}, {t.z, ca, bc}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

inline MeshPtr moved(const TriangleMesh& mesh, float scale, const Vec3& center) {
    std::vector<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(center + scale * p);
    return make_mesh(std::move(positions), mesh.triangles);
}

/// A point of an edge (half), a vertex (a quarter) or a face.
inline Vec3 aim(const TriangleMesh& mesh, Random& random) {
    const glm::uvec3 t = mesh.triangles[random.bits() % mesh.triangles.size()];
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    switch (random.integer(0, 3)) {
        case 0:
            return a;
        case 1:
            return glm::mix(a, glm::mix(b, c, random.uniform()), random.uniform());
        default:
            return glm::mix(a, b, random.uniform());
    }
}

}  // namespace rayuela::test
