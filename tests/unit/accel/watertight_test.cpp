#include "core/shapes/intersect_triangle.h"
#include "tests/support/closed_meshes.h"

#include <gtest/gtest.h>

namespace rayuela::test {
namespace {

struct Crossings {
    int front = 0, back = 0;
};

Crossings count_hits(const TriangleMesh& mesh, const Ray& ray) {
    const TriangleRay exact{RayD(ray)};
    Crossings crossings;
    for (const glm::uvec3& t : mesh.triangles) {
        const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
        ShapeHit hit;
        if (!intersect_triangle(exact, a, b, c, {}, hit)) continue;
        const Vec3d n = glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
        ++(glm::dot(n, Vec3d(ray.direction)) < 0 ? crossings.front : crossings.back);
    }
    return crossings;
}

class Watertight : public ::testing::TestWithParam<std::tuple<int, float>> {};

/// A ray from inside a closed mesh always meets it, wherever the mesh lies and however large it is.
TEST_P(Watertight, NoRayLeavesAClosedMesh) {
    const auto [which, scale] = GetParam();
    const MeshPtr unit = which == 0 ? make_tetrahedron() : which == 1 ? make_cube() : make_ball(8, 1, Vec3(0), 0.1f, 3);
    const int count = which == 2 ? 4000 : 30000;
    for (const Vec3 center : {Vec3(0), Vec3(148376, 1234, -223423), Vec3(1e6f)}) {
        if (scale < 1 && center != Vec3(0)) continue;  // Vertices would coincide in float.
        const MeshPtr mesh = moved(*unit, scale, center);
        Random random(17);
        int leaks = 0;
        for (int i = 0; i < count; ++i) {
            Ray ray{.origin = center + scale * random.in_cube(0.15f)};
            ray.direction = aim(*mesh, random) - ray.origin;
            if (random.integer(0, 1)) ray.direction = glm::normalize(ray.direction);
            if (count_hits(*mesh, ray).back == 0) ++leaks;
        }
        EXPECT_EQ(leaks, 0) << "center " << center.x << " scale " << scale;
    }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Watertight,
                         ::testing::Combine(::testing::Values(0, 1, 2),
                                            ::testing::Values(1e-12f, 1e-6f, 1e-3f, 1.0f, 37.7f, 1e6f)));

/// From outside the first surface met faces the ray.
TEST(WatertightMesh, FirstHitFromOutsideIsAFront) {
    const MeshPtr mesh = make_ball(10, 1, Vec3(0), 0.0f, 1);
    Random random(4);
    for (int i = 0; i < 20000; ++i) {
        Ray ray{.origin = 3.0f * random.direction()};
        ray.direction = aim(*mesh, random) - ray.origin;
        const TriangleRay exact{RayD(ray)};
        double facing = 0;
        float closest = kInfinity;
        for (const glm::uvec3& t : mesh->triangles) {
            const Vec3 &a = mesh->positions[t.x], &b = mesh->positions[t.y], &c = mesh->positions[t.z];
            ShapeHit hit;
            if (!intersect_triangle(exact, a, b, c, {}, hit)) continue;
            const double f = glm::dot(glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)), Vec3d(ray.direction));
            if (hit.t < closest || (hit.t == closest && f < facing)) {
                closest = hit.t;
                facing = f;
            }
        }
        if (closest == kInfinity) continue;
        ASSERT_LT(facing, 0) << i;
    }
}

/// A square in ever smaller triangles, looked at on the pixel grid of the vertices themselves.
TEST(WatertightMesh, SubdividedSquareHasNoHoles) {
    for (const int cells : {2, 4, 16, 32}) {
        const MeshPtr mesh = make_grid(cells, 0);
        const auto kd = build({{mesh, {}}}, {.kind = AcceleratorKind::kd});
        for (int j = 1; j < 128; ++j) {
            for (int i = 1; i < 128; ++i) {
                const Vec3 target(-1 + static_cast<float>(i) / 64, 0, -1 + static_cast<float>(j) / 64);
                const Vec3 origin(0.3f, 2, -0.4f);
                ASSERT_TRUE(intersect(*kd, {.origin = origin, .direction = target - origin}).valid()) << i << ' ' << j;
            }
        }
    }
}

}  // namespace
}  // namespace rayuela::test
