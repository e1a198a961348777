#include "core/io/mesh_builder.h"

#include "core/io/put_aside.h"
#include "core/math/float_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

namespace rayuela {

namespace {

/// Larger polygons that are not convex become fans, because cutting ears takes quadratic time.
constexpr std::size_t kMaxEarCorners = 256;

using Vec2d = glm::dvec2;

double cross(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon seen along its normal (Newell's method), counter-clockwise.
std::vector<Vec2d> project(std::span<const std::uint32_t> corners, std::span<const Vec3> positions) {
    Vec3d normal{0};
    const Vec3d origin = positions[corners[0]];
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = Vec3d(positions[corners[i]]) - origin;
        const Vec3d b = Vec3d(positions[corners[(i + 1) % corners.size()]]) - origin;
        normal += glm::cross(a, b);
    }
    const Vec3d size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Vec2d> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners) {
        const Vec3d p = Vec3d(positions[corner]) - origin;
        points.emplace_back(normal[axis] < 0 ? Vec2d(p[v], p[u]) : Vec2d(p[u], p[v]));
    }
    return points;
}

bool is_convex(const std::vector<Vec2d>& points) {
    const std::size_t n = points.size();
    double turned = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2d& a = points[i];
        const Vec2d& b = points[(i + 1) % n];
        const Vec2d& c = points[(i + 2) % n];
        if (cross(a, b, c) < 0) return false;
        turned += std::atan2(cross(a, b, c), glm::dot(b - a, c - b));
    }
    return turned < 3 * 3.14159265358979;  // A star turns more than once.
}

bool is_ear(const std::vector<Vec2d>& points, const std::vector<std::uint32_t>& rest, std::size_t at) {
    const std::size_t n = rest.size();
    const Vec2d& a = points[rest[(at + n - 1) % n]];
    const Vec2d& b = points[rest[at]];
    const Vec2d& c = points[rest[(at + 1) % n]];
    if (!(cross(a, b, c) > 0)) return false;
    for (std::size_t i = 2; i + 1 < n; ++i) {
        const Vec2d& p = points[rest[(at + i) % n]];
        if (p == a || p == b || p == c) continue;
        if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
}

/// Cuts ears off `rest` until three corners or no ear are left.
void cut_ears(const std::vector<Vec2d>& points, std::vector<std::uint32_t>& rest, std::vector<glm::uvec3>& triangles) {
    std::size_t at = 0, misses = 0;
    while (rest.size() > 3 && misses < rest.size()) {
        const std::size_t n = rest.size();
        if (is_ear(points, rest, at)) {
            triangles.emplace_back(rest[(at + n - 1) % n], rest[at], rest[(at + 1) % n]);
            rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(at));
            at %= rest.size();
            misses = 0;
        } else {
            at = (at + 1) % n;
            ++misses;
        }
    }
}

void fan(const std::vector<std::uint32_t>& rest, std::vector<glm::uvec3>& triangles) {
    for (std::size_t i = 1; i + 1 < rest.size(); ++i) triangles.emplace_back(rest[0], rest[i], rest[i + 1]);
}

/// Normals of length 1; the indices of those that could not be saved.
std::vector<std::uint32_t> normalize_normals(std::vector<Vec3>& normals) {
    std::vector<std::uint32_t> bad;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Vec3d normal = normals[i];
        const double length = glm::length(normal);
        if (length > 0 && std::isfinite(length)) {
            // Unit within rounding stays as it is, so that writing and reading changes nothing.
            if (std::abs(length - 1) > 1e-6) normals[i] = Vec3(normal / length);
        } else {
            normals[i] = Vec3(0);
            bad.push_back(static_cast<std::uint32_t>(i));
        }
    }
    return bad;
}

/// Unit; none where the triangle has no area.
std::optional<Vec3> face_normal(const TriangleMesh& mesh, const glm::uvec3& t) {
    const Vec3d a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const Vec3d normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    return Vec3(normal / length);
}

void use_face_normals(TriangleMesh& mesh) {
    for (const glm::uvec3& t : mesh.triangles) {
        const std::optional<Vec3> normal = face_normal(mesh, t);
        for (int corner = 0; normal && corner < 3; ++corner) {
            if (mesh.normals[t[corner]] == Vec3(0)) mesh.normals[t[corner]] = *normal;
        }
    }
    for (Vec3& normal : mesh.normals) {
        if (normal == Vec3(0)) normal = Vec3(0, 1, 0);  // Of no triangle with an area: never seen.
    }
}

/// Whether all normals are those of the faces, but for what a program loses that works them out in float: they say nothing.
bool are_of_faces(const TriangleMesh& mesh) {
    return std::ranges::all_of(mesh.triangles, [&](const glm::uvec3& t) {
        const std::optional<Vec3> face = face_normal(mesh, t);
        if (!face) return true;
        const auto is_same = [&](std::uint32_t i) {
            return max_component(glm::abs(mesh.normals[i] - *face)) <= gamma(8);
        };
        return is_same(t.x) && is_same(t.y) && is_same(t.z);
    });
}

}  // namespace

void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3> positions,
                 std::vector<glm::uvec3>& triangles) {
    if (corners.size() == 3) {
        triangles.emplace_back(0, 1, 2);
        return;
    }
    std::vector<std::uint32_t> rest(corners.size());
    std::iota(rest.begin(), rest.end(), 0u);
    const std::vector<Vec2d> points = project(corners, positions);
    if (corners.size() <= kMaxEarCorners && !is_convex(points)) cut_ears(points, rest, triangles);
    fan(rest, triangles);
}

MeshResult finish_mesh(TriangleMesh mesh, const std::string& name, Problems* warnings) {
    if (mesh.triangles.empty()) return fail(name, "", "has no faces");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (!is_finite(mesh.positions[i])) return fail(name, fmt::format("vertex {}", i), "is not finite");
        mesh.bounds.extend(mesh.positions[i]);
    }
    const std::vector<std::uint32_t> bad = normalize_normals(mesh.normals);
    if (!bad.empty()) {
        use_face_normals(mesh);
        if (warnings) {
            warnings->push_back(
                {name, fmt::format("vertex {}", bad.front()),
                 fmt::format("{} normals are missing or no directions: normals of faces are used", bad.size())});
        }
    }
    if (!mesh.normals.empty() && are_of_faces(mesh)) mesh.normals.clear();
    for (Vec2& uv : mesh.uvs) {
        if (!is_finite(Vec3(uv, 0))) uv = Vec2(0);
    }
    if (mesh.uvs.size() * sizeof(Vec2) >= kSmallestAside && (mesh.uvs_aside = put_aside(mesh.uvs))) mesh.uvs.clear();
    // Readers do not know how much will come.
    mesh.positions.shrink_to_fit();
    mesh.normals.shrink_to_fit();
    mesh.uvs.shrink_to_fit();
    mesh.triangles.shrink_to_fit();
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

}  // namespace rayuela
