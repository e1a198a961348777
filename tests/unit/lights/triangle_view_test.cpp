#include "core/lights/triangle_view.h"
#include "core/lights/area_light.h"
#include "tests/statistics.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

using test::Random;
using Corners = std::array<Vec3, 3>;

/// Girard's theorem: the angles between the planes through the edges.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto angle = [](const Vec3d& at, const Vec3d& to, const Vec3d& from) {
        const Vec3d m = glm::cross(at, to), n = glm::cross(at, from);
        return std::atan2(glm::length(glm::cross(m, n)), glm::dot(m, n));
    };
    return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - std::numbers::pi;
}
double solid_angle(const Corners& c) {
    return solid_angle(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2]));
}

TriangleView view_of(const Corners& c) {
    const Vec3d across = glm::cross(Vec3d(c[1]) - Vec3d(c[0]), Vec3d(c[2]) - Vec3d(c[0]));
    const double twice = glm::length(across);
    return {c, static_cast<float>(0.5 * twice), static_cast<float>(std::abs(glm::dot(across, Vec3d(c[0]))) / twice)};
}

/// Of edges about 1, at a height of at least an eighth: above the triangle or beside it.
Corners random_corners(Random& random) {
    while (true) {
        const float height = std::exp2(random.uniform(-3, 3));
        Corners c;
        for (Vec3& corner : c) corner = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), height);
        const Vec3 shift = std::exp2(random.uniform(-5, 1)) * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0);
        const Mat3 turn = random.rotation();
        const float twice = std::abs(glm::cross(c[1] - c[0], c[2] - c[0]).z);
        for (Vec3& corner : c) corner = turn * (corner + shift);
        if (twice > 0.05f) return c;
    }
}

Vec3d point(const Corners& c, double x, double y) {
    return (1 - x - y) * Vec3d(c[0]) + x * Vec3d(c[1]) + y * Vec3d(c[2]);
}

TEST(TriangleView, SolidAngle) {
    EXPECT_NEAR(view_of({Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}).solid_angle(), 4 * std::numbers::pi / 8, 1e-6)
        << "face of an octahedron";
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const Corners corners = random_corners(random);
        ASSERT_NEAR(view_of(corners).solid_angle() / solid_angle(corners), 1, 1e-5);
    }
}

TEST(TriangleView, SmallOnesLoseNothing) {
    Random random(2);
    for (int i = 0; i < 10'000; ++i) {
        // Exact in float: the corners are what the expected value is worked out from.
        const float size = std::exp2(static_cast<float>(random.integer(-10, -3)));
        const Corners corners{Vec3(0, 0, 1), Vec3(size, 0, 1), Vec3(size * 0.25f, size, 1)};
        const TriangleView view = view_of(corners);
        ASSERT_NEAR(view.solid_angle() / solid_angle(corners), 1, 1e-5) << size;
        // Seen from far away it is drawn as evenly over its area.
        const Vec2 at = view.sample({0.5f, 0.25f}, view.solid_angle());
        ASSERT_NEAR(at.x, 0.25, 0.25 * size) << size;
        ASSERT_NEAR(at.y, 0.25, 0.25 * size) << size;
    }
}

TEST(TriangleView, SamplesAreEvenInSolidAngle) {
    Random random(3);
    constexpr int kViews = 60, kSide = 6, kCount = 1 << 15;
    for (int k = 0; k < kViews; ++k) {
        const Corners corners = random_corners(random);
        const TriangleView view = view_of(corners);
        const float angle = view.solid_angle();
        // Small triangles; the second half of the cells are those that stand on a corner.
        std::vector<double> observed(2 * kSide * kSide), expected(2 * kSide * kSide);
        for (int i = 0; i < kCount; ++i) {
            const Vec2 at = view.sample({random.uniform(), random.uniform()}, angle);
            ASSERT_TRUE(at.x >= 0 && at.y >= 0 && at.x + at.y <= 1 + 0x1p-22f);
            const float x = at.x * kSide, y = at.y * kSide;
            const int column = std::min(static_cast<int>(x), kSide - 1), row = std::min(static_cast<int>(y), kSide - 1);
            const bool upper = x - static_cast<float>(column) + y - static_cast<float>(row) > 1;
            ++observed[static_cast<std::size_t>((upper ? kSide * kSide : 0) + row * kSide + column)];
        }
        for (int row = 0; row < kSide; ++row) {
            for (int column = 0; column + row < kSide; ++column) {
                const auto at = [&](int x, int y) { return point(corners, double(x) / kSide, double(y) / kSide); };
                const Vec3d right = at(column + 1, row), above = at(column, row + 1);
                const auto cell = static_cast<std::size_t>(row * kSide + column);
                const double scale = kCount / solid_angle(corners);
                expected[cell] = scale * solid_angle(at(column, row), right, above);
                if (column + row + 1 < kSide)
                    expected[kSide * kSide + cell] = scale * solid_angle(right, at(column + 1, row + 1), above);
            }
        }
        EXPECT_GT(test::chi_square_test(observed, expected), test::sidak(0.01, kViews)) << k;
    }
}

TEST(TriangleView, NumbersCutOffTheirShare) {
    // u.x is the share of the solid angle on one side of the line from the first corner through the point; u.y what a line
    // between points of the same u.x cuts off. So strata stay together, and their sizes are right.
    Random random(4);
    for (int k = 0; k < 2000; ++k) {
        const Corners corners = random_corners(random);
        const TriangleView view = view_of(corners);
        const double whole = solid_angle(corners);
        const Vec2 u(random.uniform(0.02f, 0.98f), random.uniform(0.02f, 0.98f));
        const Vec2 at = view.sample(u, view.solid_angle());
        const double x = at.x / (double{at.x} + at.y);
        const double share = solid_angle(Vec3d(corners[0]), Vec3d(corners[1]), point(corners, x, 1 - x)) / whole;
        ASSERT_NEAR(share, u.x, 2e-5) << k;
        const Vec3d first = glm::normalize(Vec3d(corners[0])), far = glm::normalize(point(corners, x, 1 - x));
        const double cosine = glm::dot(first, glm::normalize(point(corners, at.x, at.y)));
        ASSERT_NEAR((1 - cosine) / (1 - glm::dot(first, far)), u.y, 1e-4) << k;
    }
}

TEST(TriangleView, NumbersOfAPositionAreThoseItWasDrawnBy) {
    Random random(7);
    for (int k = 0; k < 50'000; ++k) {
        const TriangleView view = view_of(random_corners(random));
        const float angle = view.solid_angle();
        const Vec2 u(random.uniform(), random.uniform(0.02f, 1));
        const Vec2 found = view.numbers_of(view.sample(u, angle), angle);
        ASSERT_NEAR(found.x, u.x, 1e-4) << k;
        ASSERT_NEAR(found.y, u.y, 1e-4) << k;
    }
    const TriangleView view = view_of({Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1)});
    const Vec2 corners[] = {Vec2(0), Vec2(1, 0), Vec2(0, 1)}, numbers[] = {Vec2(0), Vec2(0, 1), Vec2(1)};
    for (int i = 0; i < 3; ++i) {
        const Vec2 found = view.numbers_of(corners[i], view.solid_angle());
        EXPECT_NEAR(found.x, numbers[i].x, 1e-6);
        EXPECT_NEAR(found.y, numbers[i].y, 1e-6);
    }
}

TEST(TriangleView, ExtremeNumbers) {
    Random random(5);
    constexpr float kMost = 1 - 0x1p-24f;
    for (int k = 0; k < 10'000; ++k) {
        const TriangleView view = view_of(random_corners(random));
        const float angle = view.solid_angle();
        for (const float x : {0.0f, 0x1p-32f, 0.5f, kMost}) {
            for (const float y : {0.0f, 0x1p-32f, 0.5f, kMost}) {
                const Vec2 at = view.sample({x, y}, angle);
                ASSERT_TRUE(at.x >= 0 && at.y >= 0 && at.x + at.y <= 1 + 0x1p-22f) << k;
            }
            ASSERT_EQ(view.sample({x, 0}, angle), Vec2(0));
        }
        const Vec2 second = view.sample({0, kMost}, angle), third = view.sample({kMost, kMost}, angle);
        ASSERT_NEAR(second.x, 1, 1e-4);
        ASSERT_NEAR(second.y, 0, 1e-4);
        ASSERT_NEAR(third.x, 0, 1e-4);
        ASSERT_NEAR(third.y, 1, 1e-4);
    }
}

TEST(TriangleView, LampsOfAnyFormAreSampledWithTheDensityOfTheirDirections) {
    // Slivers of all kinds, and points in the plane, over an edge or a corner, close and far.
    Random random(6);
    int close = 0;
    for (int k = 0; k < 200'000; ++k) {
        const Mat3 turn = random.rotation();
        const Vec3 u = turn[0], v = std::exp2(random.uniform(-20, 0)) * turn[1] + random.uniform(-2, 2) * turn[0];
        AreaLight light{.two_sided = true, .radiance = Color(1)};
        light.place(AreaLight::Kind::triangle, random.in_cube(), u, v);
        const float height = std::exp2(random.uniform(-30, 2)) * (k % 2 == 0 ? 1.0f : -1.0f);
        const float x = static_cast<float>(random.integer(-1, 3)) / 2,
                    y = static_cast<float>(random.integer(-1, 3)) / 2;
        const LightReceiver receiver{light.origin + x * u + y * v + height * light.normal};
        const auto s = light.sample(receiver, {random.uniform(), random.uniform()});
        if (!s) continue;
        ASSERT_TRUE(s->pdf > 0 && s->pdf < kInfinity && is_finite(s->wi) && is_finite(s->target));
        const Vec3 middle = light.origin + 0.5f * light.diagonal() - receiver.p;
        if (glm::dot(middle, middle) > 0.99f * light.close2 || height * height < 1.01f * kLeastHeight2 * light.close2)
            continue;
        ++close;
        const Vec3d a = Vec3d(light.origin) - Vec3d(receiver.p);
        ASSERT_NEAR(solid_angle(a, a + Vec3d(u), a + Vec3d(v)) * s->pdf, 1, 1e-3) << k;
        // Even for directions that nobody drew.
        const Vec3 other = light.origin + 0.25f * u + 0.25f * v;
        ASSERT_EQ(light.pdf(receiver, glm::normalize(other - receiver.p), other, light.normal), s->pdf) << k;
    }
    EXPECT_GT(close, 5000);
}

}  // namespace
}  // namespace rayuela
