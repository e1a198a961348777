#include "core/lights/targets.h"

#include "core/accel/surface_point.h"
#include "core/lights/light_emission.h"
#include "core/math/sampler.h"
#include "core/math/sampling.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

std::vector<Ball> random_balls(std::uint32_t count) {
    std::vector<Ball> balls;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Sampler sampler(SamplerKind::independent, 5, count, i);
        balls.push_back({8.0f * Vec3(sampler.get_2d(0), sampler.get_1d(1)) - 4.0f, 0.02f + sampler.get_1d(2)});
    }
    return balls;
}

std::vector<std::vector<Ball>> cases() {
    return {{{Vec3(0, 0, 3), 1}},   {{Vec3(0.2f, 0, 0.1f), 1}},  // around the point
            {{Vec3(0), kInfinity}}, {{Vec3(2, 0, 0.3f), 1}, {Vec3(0, 3, 1), 0.2f}, {Vec3(0, 0, -2), 1}},
            random_balls(20),       random_balls(300)};
}

TEST(Targets, DensityIsThatOfTheSamples) {
    const Vec3 p(0.1f, -0.2f, 0), n = glm::normalize(Vec3(0.1f, 0.2f, 1));
    for (const auto& balls : cases()) {
        const Targets targets(balls);
        const TargetView view(targets, p, n);
        ASSERT_GT(view.extent(), 0);
        // Means of some functions of the direction over samples above the surface, and by the density.
        constexpr int kFunctions = 5;
        const auto functions = [](const Vec3& w) {
            return std::array<float, kFunctions>{1, w.x, w.y, w.x * w.y, w.z * w.z};
        };
        std::array<test::Moments, kFunctions> drawn, integrated;
        for (std::uint32_t i = 0; i < 40'000; ++i) {
            const Sampler sampler(SamplerKind::independent, 9, 0, i);
            const Vec3 w = view.sample(sampler.get_1d(0), sampler.get_2d(1));
            ASSERT_NEAR(glm::length(w), 1, 1e-5);
            const bool above = glm::dot(w, n) > 0;
            if (above) {
                ASSERT_GT(view.pdf(w), 0);
            } else {
                ASSERT_EQ(view.pdf(w), 0);
            }
            const Vec3 even = sample_uniform_sphere(sampler.get_2d(2));
            for (std::size_t k = 0; k < kFunctions; ++k) {
                drawn[k].add(above ? double{functions(w)[k]} : 0.0);
                integrated[k].add(double{functions(even)[k]} * double{view.pdf(even)} / double{kUniformSpherePdf});
            }
        }
        for (std::size_t k = 0; k < kFunctions; ++k) {
            EXPECT_NEAR(drawn[k].mean(), integrated[k].mean(), 5 * std::hypot(drawn[k].error(), integrated[k].error()))
                << balls.size() << " balls, function " << k;
        }
    }
}

TEST(Targets, EveryBallIsAimedAt) {
    for (const std::uint32_t count : {3u, 32u, 33u, 500u}) {
        const std::vector<Ball> balls = random_balls(count);
        const Targets targets(balls);
        const Vec3 p(0, 0, -9), n(0, 0, 1);
        const TargetView view(targets, p, n);
        for (const Ball& ball : balls) EXPECT_GT(view.pdf(glm::normalize(ball.center - p)), 0);
    }
}

TEST(Targets, NothingBelowTheSurface) {
    const Targets targets({{Vec3(0, 0, -3), 1}});
    const TargetView view(targets, Vec3(0), Vec3(0, 0, 1));
    EXPECT_EQ(view.extent(), 0);
    EXPECT_EQ(view.pdf(Vec3(0, 0, 1)), 0);
}

struct Lamps {
    std::vector<GeometryInstance> instances;
    Material material;
    std::shared_ptr<const LightTable> table;

    Lamps(std::vector<GeometryInstance> instances_, bool two_sided)
        : instances(std::move(instances_)), material(Emitter{{Color(2, 3, 4), nullptr}, two_sided}) {
        const std::vector<const Material*> materials(instances.size(), &material);
        table = std::make_shared<const LightTable>(instances, materials, NoEnvironment{});
    }
};

TEST(LightEmission, BringsTheLightThatATargetReceives) {
    // A small lamp straight below a ball sends it L A pi sin^2(half angle).
    const Ball ball{Vec3(0, 0, 4), 1};
    const Lamps lamp({{Quad{Vec3(-0.005f, -0.005f, 0), Vec3(0.01f, 0, 0), Vec3(0, 0.01f, 0)}, {}},
                      {Quad{Vec3(50, 0, 0), Vec3(0.001f, 0, 0), Vec3(0, 0.001f, 0)}, {}}},
                     false);
    const LightEmission emission(lamp.table, {ball, {Vec3(3, 3, 3), 0.5f}});
    test::Moments flux;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        const Sampler s(SamplerKind::sobol, 2, 0, i);
        const auto emitted = emission.sample(s.get_1d(0), s.get_2d(1), s.get_1d(2), s.get_2d(3));
        if (!emitted) continue;
        const Vec3 to_ball = ball.center - emitted->ray.origin;
        const float along = glm::dot(to_ball, emitted->ray.direction);
        const bool hits = along > 0 && glm::dot(to_ball, to_ball) - along * along < ball.radius * ball.radius;
        flux.add(hits ? double{emitted->power.x} : 0.0);
    }
    EXPECT_NEAR(flux.mean() / (2 * 1e-4 * std::numbers::pi / 16), 1, 0.01);
}

TEST(LightEmission, DensityIsThatOfTheSamples) {
    for (const bool two_sided : {false, true}) {
        const Lamps lamps({{Quad{Vec3(-1, 0, 0), Vec3(1, 0, 0.2f), Vec3(0, 0.7f, 0)}, {}},
                           {Sphere{Vec3(2, 1, 0), 0.4f}, {}},
                           {Triangle{{Vec3(0, 3, 0), Vec3(1, 3, 0), Vec3(0.3f, 3.4f, 1)}}, {}}},
                          two_sided);
        const LightEmission emission(lamps.table, {{Vec3(0, 0, 4), 1}, {Vec3(1, 1, -3), 0.6f}});
        BuildControl control;
        const auto accelerator = Accelerator::build(lamps.instances, {.kind = AcceleratorKind::list}, nullptr, control);
        int found = 0;
        for (std::uint32_t i = 0; i < 3000; ++i) {
            const Sampler s(SamplerKind::independent, 2, 0, i);
            const auto emitted = emission.sample(s.get_1d(0), s.get_2d(1), s.get_1d(2), s.get_2d(3));
            if (!emitted) continue;
            // Which lamp it has left, and where: the nearest surface behind it.
            const Ray back{emitted->ray.origin, 0, -emitted->ray.direction, 1e-3f};
            Hit hit;
            accelerator->intersect({&back, 1}, {&hit, 1});
            if (!hit.valid()) continue;
            ++found;
            const SurfacePoint at = surface_point(lamps.instances, back, hit);
            if (emitted->cosine < 0.1f) continue;  // where the surface of a sphere is found less exactly
            const float pdf = emission.pdf(hit, at.p, at.ng, emitted->ray.direction);
            // Directions at the edge of a cone may fall to either side of it.
            if (pdf > 0) {
                EXPECT_NEAR(pdf / emitted->pdf, 1, 2e-3);
            }
            EXPECT_NEAR(emitted->cosine, std::abs(glm::dot(at.ng, emitted->ray.direction)), 1e-4);
        }
        EXPECT_GT(found, 1000);
    }
}

TEST(LightEmission, LampShareIsTheChanceOfFindingALamp) {
    const auto quad = [](float z, float side) {
        return Quad{Vec3(-side / 2, -side / 2, z), Vec3(side, 0, 0), Vec3(0, side, 0)};
    };
    const std::vector<Ball> target{{Vec3(0, 0, 10), 0.5f}};
    const Lamps one({{quad(0, 0.2f), {}}}, false);
    const double small = 0.04 / (2 * std::numbers::pi * 100);
    EXPECT_NEAR(LightEmission(one.table, target).lamp_share() / small, 1, 1e-3);
    // Two lamps of the same radiance, one of 100 times the area: it sends 100 times the light, and so is in the end found
    // as often for the light that it sends as the small one is.
    const Lamps two({{quad(0, 0.2f), {}}, {quad(0, 2), {}}}, false);
    EXPECT_NEAR(LightEmission(two.table, target).lamp_share() / (101 * small / 2), 1, 0.02);
    EXPECT_EQ(LightEmission(one.table, {{Vec3(0), kInfinity}}).lamp_share(), 1) << "not to be aimed at";
    const Lamps ball({{Sphere{Vec3(0, 0, 4), 1}, {}}}, false);
    EXPECT_NEAR(LightEmission(ball.table, target).lamp_share(), 1 / 72.0, 1e-5);
}

TEST(LightEmission, EmptyWhereNoLampShinesTowardsATarget) {
    const Lamps lamp({{Quad{Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {}}}, false);
    EXPECT_TRUE(LightEmission(lamp.table, {{Vec3(0, 0, -3), 1}}).empty());
    EXPECT_FALSE(LightEmission(lamp.table, {{Vec3(0, 0, 3), 1}}).empty());
    EXPECT_TRUE(LightEmission(std::make_shared<const LightTable>(), {{Vec3(0, 0, 3), 1}}).empty());
}

}  // namespace
}  // namespace rayuela
