#include "core/lights/area_light.h"
#include "core/lights/corner_warp.h"
#include "core/lights/triangle_view.h"
#include "core/math/sampler.h"
#include "tests/statistics.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

using test::Random;

/// Solid angle of a rectangle from (0, 0) to (x, y) at distance z.
double corner_angle(double x, double y, double z) {
    return std::atan(x * y / (z * std::sqrt(x * x + y * y + z * z)));
}
double solid_angle(const RectangleView& v, double x0, double x1, double y0, double y1) {
    const double z = v.z;
    return corner_angle(x1, y1, z) - corner_angle(x0, y1, z) - corner_angle(x1, y0, z) + corner_angle(x0, y0, z);
}
double solid_angle(const RectangleView& v) {
    return solid_angle(v, v.x0, v.x1, v.y0, v.y1);
}

/// Girard's theorem: the angles between the planes through the edges.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto angle = [](const Vec3d& at, const Vec3d& to, const Vec3d& from) {
        const Vec3d m = glm::cross(at, to), n = glm::cross(at, from);
        return std::atan2(glm::length(glm::cross(m, n)), glm::dot(m, n));
    };
    return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - std::numbers::pi;
}

AreaLight flat_lamp(AreaLight::Kind kind, const Vec3& origin, const Vec3& u, const Vec3& v) {
    AreaLight light{.two_sided = true};
    light.place(kind, origin, u, v);
    light.radiance = Color(1);
    return light;
}

double solid_angle(const AreaLight& light, const Vec3& p) {
    const Vec3d a = Vec3d(light.origin) - Vec3d(p), b = a + Vec3d(light.edge_u), c = a + Vec3d(light.edge_v);
    const double half = solid_angle(a, b, c);
    if (light.kind == AreaLight::Kind::triangle) return half;
    return half + solid_angle(b, b + Vec3d(light.edge_v), c);
}

/// A triangle, a parallelogram or a rectangle, turned some way.
AreaLight random_lamp(Random& random, int kind) {
    const Mat3 turn = random.rotation();
    const Vec3 u = turn[0] * std::exp2(random.uniform(-2, 1));
    const Vec3 v = std::exp2(random.uniform(-2, 1)) * (turn[1] + (kind == 2 ? 0.0f : random.uniform(-1, 1)) * turn[0]);
    return flat_lamp(kind == 0 ? AreaLight::Kind::triangle : AreaLight::Kind::parallelogram, random.in_cube(), u, v);
}

/// Far from it, near or close.
Vec3 random_point(Random& random, const AreaLight& light) {
    const Vec3 middle = light.origin + 0.5f * light.diagonal();
    return middle + glm::length(light.edge_u + light.edge_v) * std::exp2(random.uniform(-2, 3)) * random.direction();
}

RectangleView random_view(Random& random) {
    const float angle = random.uniform(0.05f, 1.5f), width = 2 * std::cos(angle), height = 2 * std::sin(angle);
    const Vec3 corner(random.uniform(-3, 2), random.uniform(-3, 2), random.uniform(kLeastHeight, 2));
    return {{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), width, height}, corner};
}

TEST(RectangleView, AngleOfAPointAgainstDouble) {
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const float x = random.uniform(-1, 1) * std::exp2(random.uniform(-30, 30)),
                    y = std::exp2(random.uniform(-30, 30));
        const double exact = std::atan2(double{y}, double{x});
        ASSERT_NEAR(angle_of(x, y) / exact, 1, 3e-7) << x << ' ' << y;
    }
    EXPECT_EQ(angle_of(1, 0), 0);
    EXPECT_EQ(angle_of(-1, 0), kPi);
    EXPECT_EQ(angle_of(0, 1), kPi / 2);
}

TEST(RectangleView, SolidAngle) {
    const RectangleFrame square{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), 2, 2};
    EXPECT_NEAR(RectangleView(square, Vec3(-1, -1, 1)).solid_angle(), 4 * std::numbers::pi / 6, 1e-6)
        << "face of a cube";
    Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        const RectangleView view = random_view(random);
        ASSERT_NEAR(view.solid_angle() / solid_angle(view), 1, 1e-5);
    }
}

TEST(RectangleView, SamplesAreEvenInSolidAngle) {
    Random random(3);
    constexpr int kViews = 40, kSide = 8, kCount = 1 << 15;
    for (int k = 0; k < kViews; ++k) {
        const RectangleView view = random_view(random);
        const float angle = view.solid_angle();
        std::vector<double> observed(kSide * kSide), expected(kSide * kSide);
        for (int i = 0; i < kCount; ++i) {
            const Vec2 at = view.sample({random.uniform(), random.uniform()}, angle);
            ASSERT_TRUE(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1);
            const auto cell = [](float x) { return std::min(static_cast<int>(x * kSide), kSide - 1); };
            ++observed[static_cast<std::size_t>(cell(at.y) * kSide + cell(at.x))];
        }
        const double width = (double{view.x1} - view.x0) / kSide, height = (double{view.y1} - view.y0) / kSide;
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const double left = view.x0 + x * width, low = view.y0 + y * height;
                expected[static_cast<std::size_t>(y * kSide + x)] =
                    kCount * solid_angle(view, left, left + width, low, low + height) / solid_angle(view);
            }
        }
        EXPECT_GT(test::chi_square_test(observed, expected), test::sidak(0.01, kViews)) << k;
    }
}

TEST(RectangleView, KeepsStrataTogether) {
    // Each number moves its own way only forwards: neighbours in the square stay neighbours on the lamp.
    Random random(4);
    for (int k = 0; k < 200; ++k) {
        const RectangleView view = random_view(random);
        const float angle = view.solid_angle();
        Vec2 before(0);
        for (int i = 0; i <= 64; ++i) {
            const Vec2 at = view.sample(Vec2(std::min(static_cast<float>(i) / 64, 1 - 0x1p-24f), 0.5f), angle);
            ASSERT_GE(at.x, before.x);
            before = at;
        }
        EXPECT_GT(before.x, 0.99f);
    }
}

TEST(RectangleView, NumbersOfAPositionAreThoseItWasDrawnBy) {
    Random random(10);
    for (int k = 0; k < 50'000; ++k) {
        const RectangleView view = random_view(random);
        const float angle = view.solid_angle();
        const Vec2 u(random.uniform(), random.uniform()), found = view.numbers_of(view.sample(u, angle), angle);
        const double tolerance = 1e-5 * (1 + 1 / angle);  // Directions are known to the rounding of their sines.
        ASSERT_NEAR(found.x, u.x, tolerance) << k;
        ASSERT_NEAR(found.y, u.y, tolerance) << k;
    }
    const RectangleView view({Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), 2, 2}, Vec3(-1, -1, 1));
    for (const Vec2& corner : {Vec2(0), Vec2(1, 0), Vec2(0, 1), Vec2(1)}) {
        const Vec2 found = view.numbers_of(corner, view.solid_angle());
        EXPECT_NEAR(found.x, corner.x, 1e-6);
        EXPECT_NEAR(found.y, corner.y, 1e-6);
    }
}

TEST(CornerWarp, CosinesOfTheDirectionsToTheCorners) {
    Random random(11);
    for (int k = 0; k < 10'000; ++k) {
        std::array<Vec3, 4> corners;
        std::array<float, 4> closeness, cosines;
        const Vec3 n = random.direction();
        for (std::size_t i = 0; i < 4; ++i) {
            corners[i] = random.in_cube();
            closeness[i] = 3 / glm::length(corners[i]);
            cosines[i] = glm::dot(glm::normalize(corners[i]), n);
        }
        const CornerWarp warp = cosine_warp(corners, closeness, n);
        const float most = *std::ranges::max_element(cosines);
        if (std::abs(most) < 0.01f) continue;  // a quotient of rounding
        for (std::size_t i = 0; i < 4; ++i) {
            const float expected = most > 0 ? std::max(cosines[i] / most, kLeastCornerShare) : 1;
            ASSERT_NEAR(warp.weights[i], expected, 1e-4) << k;
        }
        EXPECT_EQ(cosine_warp(corners, closeness, Vec3(0)).density({0.3f, 0.6f}), 1) << "from everywhere";
    }
}

TEST(CornerWarp, SamplesFollowItsDensity) {
    Random random(5);
    constexpr int kWarps = 40, kSide = 8, kCount = 1 << 15;
    for (int k = 0; k < kWarps; ++k) {
        CornerWarp warp;
        for (float& weight : warp.weights) weight = std::exp2(random.uniform(-5, 0));
        std::vector<double> observed(kSide * kSide), expected(kSide * kSide);
        for (int i = 0; i < kCount; ++i) {
            const Vec2 at = warp.sample({random.uniform(), random.uniform()});
            const auto cell = [](float x) { return std::min(static_cast<int>(x * kSide), kSide - 1); };
            ++observed[static_cast<std::size_t>(cell(at.y) * kSide + cell(at.x))];
        }
        double sum = 0;
        for (const float weight : warp.weights) sum += weight;
        for (int i = 0; i < kSide * kSide; ++i) {
            // Bilinear: the mean over a cell is the value in its middle.
            const double x = (i % kSide + 0.5) / kSide, y = (i / kSide + 0.5) / kSide;
            const auto& w = warp.weights;
            const double value = (1 - y) * ((1 - x) * w[0] + x * w[1]) + y * ((1 - x) * w[2] + x * w[3]);
            EXPECT_NEAR(warp.density({x, y}) / (4 * value / sum), 1, 1e-6);
            expected[static_cast<std::size_t>(i)] = kCount * 4 * value / sum / (kSide * kSide);
        }
        EXPECT_GT(test::chi_square_test(observed, expected), test::sidak(0.01, kWarps)) << k;
    }
}

TEST(FlatLamp, InverseDensitiesAverageToTheSolidAngle) {
    Random random(6);
    int bent = 0;
    for (int k = 0; k < 300; ++k) {
        const AreaLight light = random_lamp(random, k % 3);
        const Vec3 p = random_point(random, light);
        const double height = std::abs(glm::dot(light.normal, p - light.origin)) / glm::length(light.diagonal());
        if (height < 0.05) continue;
        const LightReceiver receiver{p, k % 2 == 0 ? Vec3(0) : random.direction()};
        test::Moments inverse;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const auto s = light.sample(receiver, Sampler(SamplerKind::independent, 1, 0, i).get_2d(0));
            ASSERT_TRUE(s);
            inverse.add(1 / double{s->pdf});
        }
        const double expected = solid_angle(light, p);
        ASSERT_NEAR(inverse.mean() / expected, 1, 5 * inverse.error() / expected + 1e-5) << k;
        bent += inverse.error() < 1e-5 * expected;
    }
    EXPECT_GT(bent, 20) << "close rectangles have one density";
}

TEST(FlatLamp, DensityOfASampleIsThatOfItsDirection) {
    Random random(7);
    for (int k = 0; k < 100'000; ++k) {
        const AreaLight light = random_lamp(random, k % 3);
        const LightReceiver receiver{random_point(random, light), k % 2 == 0 ? Vec3(0) : random.direction()};
        const auto s = light.sample(receiver, {random.uniform(), random.uniform()});
        if (!s || std::abs(glm::dot(s->wi, light.normal)) < 0.01f) continue;
        const Vec3 point = receiver.p + s->distance * s->wi;
        ASSERT_NEAR(light.pdf(receiver, s->wi, point, light.normal) / s->pdf, 1, 1e-3) << k;
    }
}

TEST(FlatLamp, PowersOfTwoOfScaleChangeNothing) {
    Random random(8);
    for (int k = 0; k < 20'000; ++k) {
        const AreaLight light = random_lamp(random, k % 3);
        const Vec3 p = random_point(random, light), n = random.direction();
        const Vec2 u(random.uniform(), random.uniform());
        const auto expected = light.sample({p, n}, u);
        for (const float scale : {0x1p-20f, 0x1p+20f}) {
            AreaLight scaled = light;
            scaled.place(light.kind, scale * light.origin, scale * light.edge_u, scale * light.edge_v);
            const auto s = scaled.sample({p * scale, n}, u);
            ASSERT_EQ(s.has_value(), expected.has_value());
            if (!s) continue;
            ASSERT_EQ(s->wi, expected->wi);
            ASSERT_EQ(s->pdf, expected->pdf);
            ASSERT_EQ(s->distance, expected->distance * scale);
        }
    }
}

/// Lambert's formula for the irradiance of a polygon of radiance 1 that is all above the horizon.
double polygon_irradiance(const Vec3d& n, const std::vector<Vec3d>& vertices) {
    double sum = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = glm::normalize(vertices[i]), b = glm::normalize(vertices[(i + 1) % vertices.size()]);
        const Vec3d c = glm::cross(a, b);
        sum += std::atan2(glm::length(c), glm::dot(a, b)) * glm::dot(n, glm::normalize(c));
    }
    return std::abs(sum) / 2;
}

TEST(FlatLamp, IrradianceAgainstTheFormFactor) {
    Random random(9);
    int tested = 0;
    for (int k = 0; k < 600; ++k) {
        const AreaLight light = random_lamp(random, k % 3);
        const LightReceiver receiver{random_point(random, light), random.direction()};
        const Vec3d a = Vec3d(light.origin) - Vec3d(receiver.p), n(receiver.n);
        std::vector<Vec3d> corners{a, a + Vec3d(light.edge_u), a + Vec3d(light.edge_v)};
        if (light.kind == AreaLight::Kind::parallelogram)
            corners.insert(corners.begin() + 2, a + Vec3d(light.edge_u) + Vec3d(light.edge_v));
        if (!std::ranges::all_of(corners, [&](const Vec3d& c) { return glm::dot(c, n) > 0; })) continue;
        if (std::abs(glm::dot(Vec3d(light.normal), a)) < 0.05 * glm::length(light.diagonal())) continue;
        ++tested;
        test::Moments mean;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const auto s = light.sample(receiver, Sampler(SamplerKind::independent, 2, 0, i).get_2d(0));
            mean.add(s ? std::max(0.0, glm::dot(n, Vec3d(s->wi))) / s->pdf : 0);
        }
        const double expected = polygon_irradiance(n, corners);
        ASSERT_NEAR(mean.mean() / expected, 1, 5 * mean.error() / expected + 1e-5) << k;
    }
    EXPECT_GT(tested, 100);
}

TEST(FlatLamp, OddPlacesGiveASampleOnTheLampOrNone) {
    // In the plane, on edges and corners, at the middle; slivers; parallel edges.
    const Vec3 edges[][2] = {{Vec3(1, 0, 0), Vec3(0, 1, 0)},
                             {Vec3(1, 0, 0), Vec3(0, 1e-7f, 0)},
                             {Vec3(1, 0, 0), Vec3(1, 1e-5f, 0)},
                             {Vec3(1e-20f, 0, 0), Vec3(0, 1e-20f, 0)},
                             {Vec3(1e15f, 0, 0), Vec3(0, 1e15f, 0)}};
    const float numbers[] = {0, 0x1p-32f, 0.5f, 1 - 0x1p-24f};
    for (const auto& [u, v] : edges) {
        for (const auto kind : {AreaLight::Kind::triangle, AreaLight::Kind::parallelogram}) {
            const AreaLight light = flat_lamp(kind, Vec3(0), u, v);
            for (const float s : {-1.0f, 0.0f, 0.5f, 1.0f}) {
                for (const float h : {0.0f, 1e-30f, 1e-7f, 0.126f, 1.0f}) {
                    const Vec3 p = s * u + 0.5f * v + h * glm::length(u) * light.normal;
                    for (const Vec3& n : {Vec3(0), light.normal, -light.normal, Vec3(1, 0, 0)}) {
                        for (const float x : numbers) {
                            for (const float y : numbers) {
                                const auto sample = light.sample({p, n}, {x, y});
                                if (!sample) continue;
                                ASSERT_TRUE(sample->pdf > 0 && sample->pdf < kInfinity);
                                ASSERT_TRUE(is_finite(sample->wi) && is_finite(sample->target));
                                const float slack = 1e-5f * glm::length(u);
                                const Vec3 at = sample->target;
                                ASSERT_TRUE(at.x >= -slack && at.x <= u.x + v.x + slack && std::abs(at.z) <= slack);
                            }
                        }
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace rayuela
