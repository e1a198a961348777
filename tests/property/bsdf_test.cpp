#include "core/materials/bsdf.h"

#include "tests/property/direction_histogram.h"
#include "tests/property/material_cases.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayuela::test {
namespace {

/// Azimuth pi, so that what is mirrored leaves at azimuth 0, in the middle of the histogram.
Vec3 direction(double degrees) {
    const double theta = degrees * std::numbers::pi / 180;
    return Vec3(glm::dvec3(-std::sin(theta), 0, std::cos(theta)));
}

constexpr double kAngles[] = {0, 35, 70, 89, 89.9, 93, 130};

Vec3 random_direction(const Sampler& sampler, std::uint32_t dimension) {
    const Vec2 u = sampler.get_2d(dimension);
    const float z = 2 * u.x - 1, r = std::sqrt(std::max(0.0f, 1 - z * z));
    return glm::normalize(Vec3(r * std::cos(2 * kPi * u.y), r * std::sin(2 * kPi * u.y), z));
}

float relative_difference(const Color& a, const Color& b) {
    return max_component(glm::abs(a - b)) / std::max(1e-20f, max_component(glm::max(a, b)));
}

TEST(BsdfProperty, SamplesFollowTheirDensity) {
    constexpr std::uint32_t kSamples = 8192;
    const std::vector<MaterialCase> cases = material_cases();
    const double level = sidak(0.01, static_cast<int>(cases.size() * std::size(kAngles)));
    std::uint32_t tested = 0;
    for (const MaterialCase& c : cases) {
        const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
        if (!bsdf.has_smooth_lobe()) continue;
        for (const double angle : kAngles) {
            const Vec3 wo = direction(angle);
            std::vector<Vec3> drawn;
            for (std::uint32_t i = 0; i < kSamples; ++i) {
                const Sampler sampler(SamplerKind::independent, 2, tested, i);
                const auto s = bsdf.sample(wo, sampler.get_1d(0), sampler.get_2d(1));
                if (s && !s->specular) drawn.push_back(s->wi);
            }
            ++tested;
            const std::size_t half = drawn.size() / 2;
            const DirectionHistogram histogram({drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(half)}, 64);
            // Of the second half of the draws; the last category: nothing drawn, or a delta.
            std::vector<double> observed(histogram.size() + 1), expected(histogram.size() + 1);
            double integral = 0;
            for (std::size_t cell = 0; cell < histogram.size(); ++cell) {
                const double share = histogram.integrate(
                    cell, [&](const Vec3& wi) { return double(bsdf.pdf(wo, wi)); }, 2e-5);
                integral += share;
                expected[cell] = share;
            }
            EXPECT_LE(integral, 1 + 2e-3) << c.name << " at " << angle;
            const double total = static_cast<double>(kSamples);
            const double kept = integral * total;
            EXPECT_NEAR(static_cast<double>(drawn.size()), kept,
                        5 * std::sqrt(kept * (1 - std::min(integral, 1.0))) + 0.01 * total)
                << c.name << " at " << angle << ": the integral of the pdf is the probability of drawing anything";
            for (std::size_t i = half; i < drawn.size(); ++i) ++observed[histogram.cell(drawn[i])];
            for (double& e : expected) e *= static_cast<double>(drawn.size() - half) / integral;
            EXPECT_GT(chi_square_test(observed, expected), level) << c.name << " at " << angle;
        }
    }
    EXPECT_GT(tested, 300u);
}

TEST(BsdfProperty, WeightIsEvalOverPdf) {
    for (const MaterialCase& c : material_cases()) {
        const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
        for (std::uint32_t i = 0; i < 500; ++i) {
            const Sampler sampler(SamplerKind::independent, 3, 0, i);
            const Vec3 wo = random_direction(sampler, 0);
            const auto s = bsdf.sample(wo, sampler.get_1d(1), sampler.get_2d(2));
            if (!s) continue;
            ASSERT_NEAR(glm::length(s->wi), 1, 1e-5) << c.name;
            ASSERT_GT(s->pdf, 0) << c.name;
            if (s->specular) {
                ASSERT_LE(s->pdf, 1) << c.name;
                continue;
            }
            const float pdf = bsdf.pdf(wo, s->wi);
            ASSERT_NEAR(s->pdf / pdf, 1, 1e-5) << c.name;
            ASSERT_LE(relative_difference(s->weight, bsdf.eval(wo, s->wi) / pdf), 1e-5f) << c.name;
        }
    }
}

TEST(BsdfProperty, NoEnergyIsMade) {
    for (const MaterialCase& c : material_cases()) {
        const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
        for (const double angle : kAngles) {
            Moments albedo;
            for (std::uint32_t i = 0; i < 2048; ++i) {
                const Sampler sampler(SamplerKind::sobol, 4, static_cast<std::uint32_t>(angle * 10), i);
                const auto s = bsdf.sample(direction(angle), sampler.get_1d(0), sampler.get_2d(1));
                albedo.add(s ? double(max_component(s->weight)) : 0);
            }
            // The table of the energy between facets is good to 0.01 at grazing angles.
            EXPECT_LE(albedo.mean(), 1.0 + 0.01 + 4 * albedo.error()) << c.name << " at " << angle;
        }
    }
}

TEST(BsdfProperty, Reciprocity) {
    std::uint32_t pairs = 0;
    for (const MaterialCase& c : material_cases()) {
        const auto* principled = std::get_if<Principled>(&c.material);
        if (principled && principled->clearcoat > 0) continue;  // its share is taken by wo alone
        const auto* glass = std::get_if<Dielectric>(&c.material);
        const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
        for (std::uint32_t i = 0; i < 2000; ++i) {
            const Sampler sampler(SamplerKind::independent, 5, 0, i);
            const Vec3 a = random_direction(sampler, 0), b = random_direction(sampler, 1);
            const auto index = [&](const Vec3& w) { return glass && w.z < 0 ? glass->ior : 1.0f; };
            const Color f = bsdf.eval(a, b) / (std::abs(b.z) * index(b) * index(b));
            const Color g = bsdf.eval(b, a) / (std::abs(a.z) * index(a) * index(a));
            const bool refracts = glass && a.z * b.z < 0;
            // Along a facet, and close to total reflection, differences are down to their rounding.
            const Vec3 m = glm::normalize(index(a) * a + index(b) * b);
            if (refracts && std::min(std::abs(glm::dot(a, m)), std::abs(glm::dot(b, m))) < 0.02f) continue;
            if (is_black(f) && is_black(g)) continue;
            ++pairs;
            ASSERT_LE(relative_difference(f, g), glass ? 5e-4f : 2e-5f)
                << c.name << " " << i << " " << f.x << " " << g.x;
        }
    }
    EXPECT_GT(pairs, 50'000u);
}

TEST(BsdfProperty, ExtremeInputGivesFiniteValuesOrNothing) {
    const float edges[] = {0, 0x1p-32f, 0.5f, 1 - 0x1p-24f};
    const float tiny = 1e-7f;
    const Vec3 directions[] = {{0, 0, 1},      {0, 0, -1},    {1, 0, 0},       {0, 1, 0},
                               {1, 0, tiny},   {1, 0, -tiny}, {0.6f, 0, 0.8f}, {0.6f, 0, -0.8f},
                               {1, 0, 1e-30f}, {NAN, 0, 1},   {0, 0, 0}};
    for (const MaterialCase& c : material_cases()) {
        const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
        for (const Vec3& wo : directions) {
            for (const Vec3& wi : directions) {
                ASSERT_TRUE(is_finite(bsdf.eval(wo, wi))) << c.name;
                ASSERT_TRUE(bsdf.pdf(wo, wi) >= 0 && std::isfinite(bsdf.pdf(wo, wi))) << c.name;
            }
            for (const float u_lobe : edges) {
                for (const float x : edges) {
                    for (const float y : edges) {
                        const auto s = bsdf.sample(wo, u_lobe, Vec2(x, y));
                        if (!s) continue;
                        ASSERT_TRUE(is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf)) << c.name;
                        ASSERT_GT(s->pdf, 0) << c.name;
                        ASSERT_TRUE(glm::all(glm::greaterThanEqual(s->weight, Vec3(0)))) << c.name;
                    }
                }
            }
        }
    }
}

TEST(BsdfProperty, SpecularOnlyMeansNoSmoothLobe) {
    for (const MaterialCase& c : material_cases()) {
        const bool smooth = make_bsdf(c.material, Vec2(0)).has_smooth_lobe();
        EXPECT_FALSE(is_specular_only(c.material) && smooth) << c.name;
        if (!smooth) continue;
        double found = 0;
        for (std::uint32_t i = 0; i < 4096 && found == 0; ++i) {
            const Sampler sampler(SamplerKind::independent, 6, 0, i);
            const Bsdf bsdf = make_bsdf(c.material, Vec2(0));
            const Vec3 wo = direction(40);
            const auto s = bsdf.sample(wo, sampler.get_1d(0), sampler.get_2d(1));
            if (s && !s->specular) found += bsdf.pdf(wo, s->wi);
        }
        const bool black =
            std::holds_alternative<Diffuse>(c.material) && is_black(std::get<Diffuse>(c.material).albedo.value);
        EXPECT_TRUE(black || found > 0) << c.name;
    }
}

}  // namespace
}  // namespace rayuela::test
