#include "core/shapes/intersect_box.h"
#include "core/shapes/intersect_plane.h"
#include "core/shapes/intersect_sphere.h"
#include "core/shapes/intersect_triangle.h"
#include "tests/support/oracle.h"

#include <gtest/gtest.h>

namespace rayuela::test {
namespace {

constexpr TRange kAll{};

TEST(Sphere, AgreesWithLongDoubleOverTwelveDecades) {
    Random random(1);
    int hits = 0;
    for (int i = 0; i < 300000; ++i) {
        const float radius = log_uniform(random, 1e-6f, 1e6f);
        const float distance = log_uniform(random, 1e-6f, 1e6f);
        const Vec3 center = random.direction() * log_uniform(random, 1e-6f, 1e6f);
        Ray ray{.origin = center + random.direction() * distance};
        ray.direction = center + random.direction() * radius * random.uniform(0, 1.2f) - ray.origin;
        if (ray.direction == Vec3(0)) continue;
        const SphereOracle expected = solve_sphere(center, radius, ray);
        ShapeHit hit;
        const bool found = intersect_sphere({Vec3d(center), radius}, RayD(ray), kAll, hit);
        if (expected.near_tangent || (expected.t && *expected.t < 1e-9L)) continue;
        ASSERT_EQ(found, expected.t.has_value()) << i;
        if (!found) continue;
        ++hits;
        // The float t itself allows half an ulp, 2^-24.
        ASSERT_NEAR(static_cast<double>(hit.t / *expected.t), 1, 1.2e-7) << i;
    }
    EXPECT_GT(hits, 100000);
}

TEST(Sphere, GroundOfAMillionRadiiIsHitWhereItIs) {
    Random random(2);
    const float radius = 1e6f;
    const Vec3 center(0, -radius, 0);
    for (int i = 0; i < 100000; ++i) {
        const Vec3 origin(random.uniform(-100, 100), random.uniform(0.01f, 50), random.uniform(-100, 100));
        Vec3 direction = random.direction();
        direction.y = -std::fabs(direction.y) - 0.05f;  // Not over the horizon.
        const Ray ray{.origin = origin, .direction = direction};
        ShapeHit hit;
        ASSERT_TRUE(intersect_sphere({Vec3d(center), radius}, RayD(ray), kAll, hit));
        const Real expected = *solve_sphere(center, radius, ray).t;
        ASSERT_NEAR(static_cast<double>(hit.t / expected), 1, 1.2e-7);
    }
}

TEST(Sphere, IsHitFromInsideAndTouchedAtItsPole) {
    ShapeHit hit;
    EXPECT_TRUE(intersect_sphere({}, RayD(Vec3d(0), Vec3d(0, 0, 2)), kAll, hit));
    EXPECT_EQ(hit.t, 0.5f);
    EXPECT_TRUE(intersect_sphere({}, RayD(Vec3d(1, -3, 0), Vec3d(0, 1, 0)), kAll, hit));
    EXPECT_EQ(hit.t, 3.0f);
    EXPECT_FALSE(intersect_sphere({}, RayD(Vec3d(0, 0, 3), Vec3d(0, 0, 1)), kAll, hit));
}

TEST(Plane, HoldsItsEquationToGrazing) {
    Random random(3);
    for (int i = 0; i < 200000; ++i) {
        const Vec3 normal = random.direction(), point = random.in_cube(100);
        const Vec3 tangent = glm::cross(normal, random.direction());
        const float cosine = (random.integer(0, 1) ? 1.0f : -1.0f) * log_uniform(random, 1e-7f, 1);
        const Vec3 direction = tangent + cosine * normal;
        const Ray ray{.origin = point - direction * random.uniform(0, 50) + normal * random.uniform(-1e-3f, 1e-3f),
                      .direction = direction};
        ShapeHit hit;
        if (!intersect_plane({Vec3d(point), Vec3d(normal)}, RayD(ray), kAll, hit)) continue;
        ASSERT_TRUE(std::isfinite(hit.t));
        const Vec3l n(normal), o(ray.origin), d(ray.direction), p0(point);
        const Real residual = glm::dot(n, o + Real(hit.t) * d - p0);
        // Half an ulp of t moves the point by that much along the direction.
        ASSERT_LE(std::fabs(residual), kU * std::fabs(hit.t * glm::dot(n, d)) + 1e-14L * 100) << i;
    }
    ShapeHit hit;
    EXPECT_FALSE(intersect_plane({}, RayD(Vec3d(0, 1, 0), Vec3d(1, 0, 0)), kAll, hit)) << "parallel";
    EXPECT_FALSE(intersect_plane({}, RayD(Vec3d(0), Vec3d(1, 0, 0)), kAll, hit)) << "within";
    EXPECT_TRUE(intersect_plane({}, RayD(Vec3d(0), Vec3d(1, -1, 0)), kAll, hit)) << "from the plane itself";
    EXPECT_EQ(hit.t, 0);
}

TEST(Box, NamesTheFaceItEntersOrLeavesBy) {
    const Box box{Vec3(-1, -2, -3), Vec3(1, 2, 3)};
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            Vec3d origin(0.1, 0.2, 0.3), direction(0);
            origin[axis] = side * 10;
            direction[axis] = -side;
            ShapeHit hit;
            ASSERT_TRUE(intersect_box(box, RayD(origin, direction), kAll, hit));
            EXPECT_EQ(hit.primitive, static_cast<std::uint32_t>(2 * axis + (side > 0 ? 1 : 0)));
            EXPECT_EQ(hit.t, 10 - box.max[axis]);
            origin[axis] = 0;
            ASSERT_TRUE(intersect_box(box, RayD(origin, direction), kAll, hit)) << "from inside";
            EXPECT_EQ(hit.primitive, static_cast<std::uint32_t>(2 * axis + (side > 0 ? 0 : 1)));
        }
    }
}

TEST(Box, NoFalseMissAtFacesEdgesAndCorners) {
    Random random(4);
    for (int i = 0; i < 200000; ++i) {
        Box box{random.in_cube(10)};
        box.max = box.min + glm::abs(random.in_cube(5));
        // A point of the box: inside, on a face, an edge or a corner.
        Vec3 target;
        for (int axis = 0; axis < 3; ++axis) {
            const float inside = glm::clamp(random.uniform(box.min[axis], box.max[axis]), box.min[axis], box.max[axis]);
            const int where = random.integer(0, 2);
            target[axis] = where == 0 ? box.min[axis] : where == 1 ? box.max[axis] : inside;
        }
        // Of few bits, so that the ray passes through the target exactly.
        Vec3d direction;
        for (int axis = 0; axis < 3; ++axis) {
            direction[axis] = random.integer(0, 3) ? random.integer(-64, 64) / 64.0 : random.integer(0, 1) ? 0.0 : -0.0;
        }
        if (direction == Vec3d(0)) continue;
        // Leaving the box's own surface counts from t = 0 on.
        ShapeHit hit;
        ASSERT_TRUE(intersect_box(box, RayD(Vec3d(target), direction), kAll, hit)) << i;
        ASSERT_TRUE(hit.t >= 0 && hit.primitive < 6);
        const double away = 1024;  // Outside the box, which is smaller than 16 * 64 steps.
        const Vec3d from = Vec3d(target) - away * direction;
        ASSERT_TRUE(intersect_box(box, RayD(from, direction), kAll, hit)) << i;
        ASSERT_LE(hit.t, away * (1 + 1e-6));
    }
}

TEST(Triangle, AgreesWithLongDouble) {
    Random random(5);
    int hits = 0;
    for (int i = 0; i < 300000; ++i) {
        const Vec3 a = random.in_cube(), b = random.in_cube(), c = random.in_cube();
        Ray ray{.origin = random.in_cube(3)};
        ray.direction = glm::mix(a, glm::mix(b, c, random.uniform()), random.uniform(-0.2f, 1.2f)) - ray.origin;
        const Vec3l d(ray.direction), e1 = Vec3l(b) - Vec3l(a), e2 = Vec3l(c) - Vec3l(a),
                                      s = Vec3l(ray.origin) - Vec3l(a);
        const Vec3l h = glm::cross(d, e2), q = glm::cross(s, e1);
        const Real determinant = glm::dot(e1, h);
        const Real u = glm::dot(s, h) / determinant, v = glm::dot(d, q) / determinant,
                   t = glm::dot(e2, q) / determinant;
        ShapeHit hit;
        const bool found = intersect_triangle(TriangleRay(RayD(ray)), a, b, c, kAll, hit);
        ASSERT_EQ(found, u >= 0 && v >= 0 && u + v <= 1 && t >= 0) << i;
        if (!found) continue;
        ++hits;
        ASSERT_NEAR(hit.u, static_cast<double>(u), 8 * 0x1p-24) << i;
        ASSERT_NEAR(hit.v, static_cast<double>(v), 8 * 0x1p-24) << i;
        ASSERT_NEAR(hit.t, static_cast<double>(t), 8 * 0x1p-24 * static_cast<double>(t) + 1e-12) << i;
    }
    EXPECT_GT(hits, 10000);
}

TEST(Triangle, DegenerateOnesAreMissedAndNothingIsNaN) {
    Random random(6);
    for (int i = 0; i < 100000; ++i) {
        Vec3 a = random.in_cube(), b = random.in_cube(), c = random.in_cube();
        const int kind = i % 4;
        if (kind == 0) b = a;
        if (kind == 1) b = c = a;
        if (kind == 2) c = 2.0f * b - a;
        if (kind == 3) c = a + (b - a) * 0.3f + random.in_cube(1e-8f);
        const Vec3 origin = random.in_cube(3);
        const RayD ray(Vec3d(origin), Vec3d(glm::mix(a, b, random.uniform()) - origin));
        ShapeHit hit;
        if (!intersect_triangle(TriangleRay(ray), a, b, c, kAll, hit)) continue;
        EXPECT_GT(kind, 1) << "no area at all";
        ASSERT_TRUE(hit.t >= 0 && hit.u >= 0 && hit.v >= 0 && hit.u <= 1 && hit.v <= 1) << i;
    }
}

TEST(Quad, ParametersRunAlongItsEdges) {
    Random random(7);
    for (int i = 0; i < 50000; ++i) {
        const Vec3 p = random.in_cube(), u = random.in_cube(), v = random.in_cube();
        const float s = random.uniform(), t = random.uniform();
        const Vec3 n = glm::cross(u, v);
        if (glm::length(n) < 0.05f) continue;
        const Vec3d target = Vec3d(p) + double{s} * Vec3d(u) + double{t} * Vec3d(v);
        ShapeHit hit;
        const RayD ray(target + 2.0 * Vec3d(n), -Vec3d(n));
        ASSERT_TRUE(intersect_quad(TriangleRay(ray), {p, p + u, p + u + v, p + v}, kAll, hit));
        // The corners are rounded to float.
        ASSERT_NEAR(hit.u, s, 1e-5f);
        ASSERT_NEAR(hit.v, t, 1e-5f);
        ASSERT_NEAR(hit.t, 2, 1e-4f);
    }
}

}  // namespace
}  // namespace rayuela::test
