#pragma once

#include "core/shapes/mesh.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace rayuela::assets {

/// Turns the zero set of a signed field into a closed, outward-facing 2-manifold with smooth normals: marching tetrahedra
/// over a body-centred cubic lattice (whose tetrahedra are all alike and nearly regular), vertices shared along lattice
/// edges, then relaxed along the surface. The field must be positive on the boundary of the box.
template <typename Field>
class Polygonizer {
public:
    Polygonizer(const Field& field, const Vec3d& min, const Vec3d& max, double cell)
        : field_(field), min_(min), half_(cell / 2) {
        for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<int>(std::ceil((max[axis] - min[axis]) / cell));
    }

    TriangleMesh run(int relaxations) {
        sample_lattice();
        for (int axis = 0; axis < 3; ++axis) march_along(axis);
        for (int i = 0; i < relaxations; ++i) relax();
        return mesh();
    }

private:
    /// In half cells: corners have even coordinates, centres odd ones.
    using Node = glm::ivec3;

    Vec3d position(const Node& node) const { return min_ + half_ * Vec3d(node); }

    std::size_t index(const Node& node) const {
        const glm::ivec3 size = 2 * cells_ + 1;
        return (static_cast<std::size_t>(node.z) * size.y + node.y) * size.x + node.x;
    }

    void sample_lattice() {
        const glm::ivec3 size = 2 * cells_ + 1;
        values_.assign(static_cast<std::size_t>(size.x) * size.y * size.z, 0);
        for (int parity = 0; parity < 2; ++parity) {
            for (int z = parity; z < size.z; z += 2) {
                for (int y = parity; y < size.y; y += 2) {
                    for (int x = parity; x < size.x; x += 2) values_[index({x, y, z})] = field_(position({x, y, z}));
                }
            }
        }
    }

    /// The four tetrahedra around each edge between two cell centres that are neighbours along `axis`.
    void march_along(int axis) {
        Node forward(0), side(0), up(0);
        forward[axis] = side[(axis + 1) % 3] = up[(axis + 2) % 3] = 1;
        const std::array<Node, 4> ring = {side + up, up - side, -side - up, side - up};
        const Node end = 2 * cells_ - forward;
        for (int z = 1; z < end.z; z += 2) {
            for (int y = 1; y < end.y; y += 2) {
                for (int x = 1; x < end.x; x += 2) {
                    const Node a(x, y, z), middle = a + forward, b = middle + forward;
                    if (b[axis] >= 2 * cells_[axis]) continue;
                    for (int i = 0; i < 4; ++i) march({a, b, middle + ring[i], middle + ring[(i + 1) % 4]});
                }
            }
        }
    }

    /// One positively oriented tetrahedron.
    void march(std::array<Node, 4> tet) {
        const auto inside = [&](const Node& node) { return values_[index(node)] < 0; };
        const int count = static_cast<int>(std::count_if(tet.begin(), tet.end(), inside));
        if (count == 0 || count == 4) return;
        // The lone corner, or the two inside, come first; an odd number of swaps is undone among the last two.
        const bool first_kind = count != 3;
        bool odd = false;
        for (int i = 0, slot = 0; i < 4; ++i) {
            if (inside(tet[i]) != first_kind) continue;
            if (i != slot) odd = !odd;
            std::swap(tet[i], tet[slot++]);
        }
        if (odd) std::swap(tet[2], tet[3]);
        if (count == 2) {
            const std::array<std::uint32_t, 4> quad = {cut(tet[0], tet[2]), cut(tet[0], tet[3]), cut(tet[1], tet[3]),
                                                       cut(tet[1], tet[2])};
            triangles_.push_back({quad[0], quad[1], quad[2]});
            triangles_.push_back({quad[0], quad[2], quad[3]});
            return;
        }
        glm::uvec3 triangle{cut(tet[0], tet[1]), cut(tet[0], tet[2]), cut(tet[0], tet[3])};  // braces fix the order
        if (count == 3) std::swap(triangle.y, triangle.z);
        triangles_.push_back(triangle);
    }

    /// The vertex where the surface cuts the lattice edge.
    std::uint32_t cut(const Node& a, const Node& b) {
        const std::uint64_t low = std::min(index(a), index(b)), high = std::max(index(a), index(b));
        const auto [entry, is_new] = vertices_.try_emplace(low * values_.size() + high, points_.size());
        if (is_new) points_.push_back(root(position(a), position(b), values_[index(a)] < 0));
        return static_cast<std::uint32_t>(entry->second);
    }

    Vec3d root(Vec3d a, Vec3d b, bool a_inside) const {
        for (int i = 0; i < 24; ++i) {
            const Vec3d middle = 0.5 * (a + b);
            ((field_(middle) < 0) == a_inside ? a : b) = middle;
        }
        return 0.5 * (a + b);
    }

    Vec3d gradient(const Vec3d& p) const {
        const double h = half_ / 64;
        return Vec3d(field_(p + Vec3d(h, 0, 0)) - field_(p - Vec3d(h, 0, 0)),
                     field_(p + Vec3d(0, h, 0)) - field_(p - Vec3d(0, h, 0)),
                     field_(p + Vec3d(0, 0, h)) - field_(p - Vec3d(0, 0, h))) /
               (2 * h);
    }

    /// Moves each vertex halfway to the mean of its neighbours, within the surface.
    void relax() {
        std::vector<Vec3d> sums(points_.size(), Vec3d(0));
        std::vector<int> counts(points_.size(), 0);
        for (const glm::uvec3& triangle : triangles_) {
            for (int i = 0; i < 3; ++i) {
                sums[triangle[i]] += points_[triangle[(i + 1) % 3]];
                ++counts[triangle[i]];
            }
        }
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Vec3d g = gradient(points_[i]);
            const Vec3d step = 0.5 * (sums[i] / static_cast<double>(counts[i]) - points_[i]);
            const Vec3d moved = points_[i] + step - g * (glm::dot(step, g) / glm::dot(g, g));
            const Vec3d slope = gradient(moved);
            points_[i] = moved - slope * (field_(moved) / glm::dot(slope, slope));
        }
    }

    TriangleMesh mesh() const {
        TriangleMesh mesh;
        mesh.triangles = triangles_;
        for (const Vec3d& p : points_) {
            mesh.positions.push_back(Vec3(p));
            mesh.normals.push_back(Vec3(glm::normalize(gradient(p))));
            mesh.bounds.extend(mesh.positions.back());
        }
        return mesh;
    }

    const Field& field_;
    Vec3d min_;
    double half_;
    glm::ivec3 cells_{0};
    std::vector<double> values_;
    std::unordered_map<std::uint64_t, std::size_t> vertices_;
    std::vector<Vec3d> points_;
    std::vector<glm::uvec3> triangles_;
};

template <typename Field>
TriangleMesh polygonize(const Field& field, const Vec3d& min, const Vec3d& max, double cell, int relaxations = 6) {
    return Polygonizer<Field>(field, min, max, cell).run(relaxations);
}

}  // namespace rayuela::assets
