#include "core/lights/light_tree.h"

#include "core/lights/light_builder.h"
#include "core/math/sampler.h"
#include "core/math/sampling.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace rayuela {
namespace {

/// Triangles, quads and spheres of all sizes and brightnesses, some two-sided, some dark.
std::vector<AreaLight> random_lights(std::size_t count, float scale = 1) {
    std::vector<AreaLight> lights;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Sampler sampler(SamplerKind::independent, 11, 0, i);
        const Vec2 a = sampler.get_2d(0), b = sampler.get_2d(1), c = sampler.get_2d(2), d = sampler.get_2d(3);
        const Vec3 at = scale * (10.0f * Vec3(a, b.x) - 5.0f);
        const float size = 0.5f * scale * b.y * b.y + scale * 0.01f;
        const Vec3 u = size * sample_uniform_sphere(c), v = size * sample_uniform_sphere(d);
        const Emitter emitter{{i % 17 == 5 ? Color(0) : Color(10 * a.x * c.x, 1, 2), nullptr}, i % 5 == 2};
        const TracedShape shape = i % 3 == 0   ? TracedShape(Sphere{at, size})
                                  : i % 3 == 1 ? TracedShape(Quad{at, u, v})
                                               : TracedShape(Triangle{{at, at + u, at + v}});
        // A black emitter has no lights; here it is to have one without power.
        append_lights({shape, {}}, Emitter{{Color(1), nullptr}, emitter.two_sided}, lights);
        lights.back().radiance = emitter.radiance.value;
    }
    return lights;
}

LightReceiver random_receiver(std::uint32_t i, float scale = 1) {
    const Sampler sampler(SamplerKind::independent, 12, 0, i);
    const Vec3 p = scale * (14.0f * Vec3(sampler.get_2d(0), sampler.get_1d(1)) - 7.0f);
    return {p, i % 4 == 0 ? Vec3(0) : sample_uniform_sphere(sampler.get_2d(2))};
}

TEST(LightTree, ProbabilitiesSumToTheChanceOfADraw) {
    for (const std::size_t count : {1u, 2u, 5u, 32u, 33u, 700u, 5000u}) {
        const std::vector<AreaLight> lights = random_lights(count);
        const LightTree tree(lights);
        ASSERT_FALSE(tree.empty());
        double all = 0, lit = 0;
        for (std::uint32_t i = 0; i < 20; ++i) {
            const LightReceiver receiver = random_receiver(i);
            double sum = 0;
            for (std::uint32_t light = 0; light < lights.size(); ++light) {
                const float p = tree.probability(receiver, light);
                EXPECT_GE(p, 0);
                if (lights[light].power() == 0) {
                    EXPECT_EQ(p, 0);
                }
                sum += double{p};
            }
            // What is missing ends at a node none of whose children turns out to light the receiver.
            int found = 0;
            for (std::uint32_t k = 0; k < 4096; ++k) {
                found += tree.draw(receiver, Sampler(SamplerKind::sobol, i, 0, k).get_1d(0)).has_value();
            }
            EXPECT_NEAR(sum, found / 4096.0, 2e-3) << count;
            all += sum;
            lit += sum > 0 ? 1 : 0;
        }
        EXPECT_GT(all, 0.75 * lit) << "draws are seldom lost";
    }
}

TEST(LightTree, DrawsFollowTheirProbabilities) {
    const std::vector<AreaLight> lights = random_lights(300);
    const LightTree tree(lights);
    constexpr std::uint32_t kDraws = 100'000;
    constexpr int kReceivers = 12;
    for (std::uint32_t i = 0; i < kReceivers; ++i) {
        const LightReceiver receiver = random_receiver(i);
        std::vector<double> observed(lights.size() + 1), expected, remainders(16), even(16, 0.0);
        for (std::uint32_t k = 0; k < kDraws; ++k) {
            const auto draw = tree.draw(receiver, Sampler(SamplerKind::independent, i, 1, k).get_1d(0));
            if (!draw) {
                ++observed[lights.size()];
                continue;
            }
            ++observed[draw->light];
            ++remainders[static_cast<std::size_t>(draw->remainder * 16)];
            ASSERT_EQ(draw->probability, tree.probability(receiver, draw->light)) << draw->light;
        }
        for (std::uint32_t light = 0; light < lights.size(); ++light) {
            expected.push_back(double{kDraws} * double{tree.probability(receiver, light)});
        }
        expected.push_back(double{kDraws} - std::accumulate(expected.begin(), expected.end(), 0.0));
        for (double& e : even) e = (kDraws - observed.back()) / 16.0;
        const double level = test::sidak(1e-4, 2 * kReceivers);
        EXPECT_GT(test::chi_square_test(observed, expected), level) << i;
        EXPECT_GT(test::chi_square_test(remainders, even), level) << i;
    }
}

TEST(LightTree, ChoosesAllAlikeOrByPowerWhereverTheReceiverIs) {
    const std::vector<AreaLight> lights = random_lights(300);
    double total = 0, shining = 0;
    for (const AreaLight& light : lights) {
        total += light.power();
        shining += light.power() > 0 ? 1 : 0;
    }
    const LightTree uniform(lights, LightChoice::uniform), by_power(lights, LightChoice::power);
    std::vector<int> drawn(lights.size());
    constexpr int kDraws = 1 << 16;
    for (std::uint32_t k = 0; k < kDraws; ++k) {
        const auto draw = uniform.draw(random_receiver(k % 8), Sampler(SamplerKind::sobol, 1, 0, k).get_1d(0));
        ASSERT_TRUE(draw.has_value());
        ++drawn[draw->light];
    }
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const double power = lights[i].power(), alike = power > 0 ? 1 / shining : 0;
        EXPECT_NEAR(uniform.probability(random_receiver(i), i), alike, 1e-6 * alike) << i;
        EXPECT_NEAR(by_power.probability(random_receiver(i), i), power / total, 1e-5 * power / total) << i;
        EXPECT_NEAR(drawn[i], kDraws * alike, 8) << i;
    }
}

TEST(LightTree, WhateverLightsTheReceiverCanBeDrawn) {
    const std::vector<AreaLight> lights = random_lights(400);
    const LightTree tree(lights);
    int lit = 0, drawable = 0;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const LightReceiver receiver = random_receiver(i);
        for (std::uint32_t light = 0; light < lights.size(); ++light) {
            bool arrives = false;
            for (std::uint32_t k = 0; k < 8 && !arrives; ++k) {
                const auto s = lights[light].sample(receiver, Sampler(SamplerKind::sobol, 3, 0, k).get_2d(0));
                arrives = s && (receiver.n == Vec3(0) || glm::dot(receiver.n, s->wi) > 1e-4f);
            }
            lit += arrives;
            drawable += tree.probability(receiver, light) > 0;
            if (arrives) {
                EXPECT_GT(tree.probability(receiver, light), 0) << i << " " << light;
            }
        }
    }
    EXPECT_GT(lit, 5000);
    EXPECT_LT(drawable, 1.3 * lit) << "but little else";
}

TEST(LightTree, PrefersWhatIsNearBrightAndFacing) {
    const auto quad = [](const Vec3& at, float radiance, bool down) {
        std::vector<AreaLight> lights;
        append_lights({Quad{at, Vec3(0.1f, 0, 0), Vec3(0, 0, down ? 0.1f : -0.1f)}, {}},
                      Emitter{{Color(radiance), nullptr}}, lights);
        return lights[0];
    };
    const LightReceiver floor{Vec3(0), Vec3(0, 1, 0)};
    const auto shares = [&](const AreaLight& a, const AreaLight& b) {
        const std::vector<AreaLight> two{a, b};
        const LightTree tree(two);
        return std::pair(tree.probability(floor, 0), tree.probability(floor, 1));
    };
    // The light of a small patch falls with the square of the distance and grows with the radiance.
    EXPECT_NEAR(shares(quad({0, 1, 0}, 1, true), quad({0, 3, 0}, 1, true)).first, 0.9, 0.02);
    EXPECT_NEAR(shares(quad({0, 2, 0}, 1, true), quad({0.1f, 2, 0}, 4, true)).second, 0.8, 0.02);
    // 60 degrees off the vertical: both cosines are a half, the distance is the same.
    const Vec3 aside = 2.0f * Vec3(std::sin(kPi / 3), std::cos(kPi / 3), 0);
    EXPECT_NEAR(shares(quad({0, 2, 0}, 1, true), quad(aside, 1, true)).first, 0.8, 0.03);
    EXPECT_EQ(shares(quad({0, 2, 0}, 1, true), quad({0.5f, 2, 0}, 100, false)).second, 0) << "shines upward";
    EXPECT_EQ(shares(quad({0, 2, 0}, 1, true), quad({0, -2, 0}, 100, false)).second, 0) << "below the floor";
}

TEST(LightTree, ScaleByAPowerOfTwoChangesNothing) {
    const LightTree tree(random_lights(300));
    for (const float scale : {0x1p-20f, 0x1p10f}) {
        const LightTree scaled(random_lights(300, scale));
        for (std::uint32_t i = 0; i < 300; ++i) {
            const float u = Sampler(SamplerKind::independent, 0, 2, i).get_1d(0);
            const auto a = tree.draw(random_receiver(i), u), b = scaled.draw(random_receiver(i, scale), u);
            ASSERT_EQ(a.has_value(), b.has_value());
            if (!a) continue;
            EXPECT_EQ(a->light, b->light);
            EXPECT_EQ(a->probability, b->probability);
            EXPECT_EQ(a->remainder, b->remainder);
        }
    }
}

TEST(LightTree, ExtremesAreDrawnWithAProbabilityOrNotAtAll) {
    std::vector<AreaLight> lights = random_lights(40);
    for (const float scale : {1e-30f, 1e-12f, 1e12f, 1e25f}) {
        for (const AreaLight& light : random_lights(10, scale)) lights.push_back(light);
    }
    lights[0].radiance = Color(1e30f);
    lights[1].radiance = Color(INFINITY);
    lights[2].radiance = Color(NAN);
    lights[4].origin = Vec3(NAN);
    const LightTree tree(lights);
    for (const Vec3& p : {Vec3(0), Vec3(1e-20f), Vec3(1e30f), Vec3(INFINITY), Vec3(NAN), lights[7].origin}) {
        for (const float u : {0.0f, 0x1p-24f, 0.3f, 1 - 0x1p-24f}) {
            const auto draw = tree.draw({p, Vec3(0, 1, 0)}, u);
            if (!draw) continue;
            ASSERT_LT(draw->light, lights.size());
            EXPECT_TRUE(draw->probability > 0 && draw->probability <= 1);
            EXPECT_TRUE(draw->remainder >= 0 && draw->remainder < 1);
        }
    }
    EXPECT_TRUE(LightTree(std::span<const AreaLight>{}).empty());
    EXPECT_EQ(LightTree().memory_bytes(), 0u);
}

TEST(LightTree, ManyLightsInOnePlaceAreStillApart) {
    std::vector<AreaLight> lights(3000, random_lights(1)[0]);
    const LightTree tree(lights);
    for (const std::uint32_t light : {0u, 1234u, 2999u}) {
        EXPECT_NEAR(tree.probability({Vec3(20, 3, 1)}, light) * 3000, 1, 1e-3);
    }
}

}  // namespace
}  // namespace rayuela
