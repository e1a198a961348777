#include "core/math/sampling.h"

#include "core/math/distribution.h"
#include "core/math/sampler.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace rayuela {
namespace {

constexpr std::uint32_t kSamples = 40'000;

Vec2 draw(std::uint32_t i, std::uint32_t dimension = 0) {
    return Sampler(SamplerKind::independent, 11, 0, i).get_2d(dimension);
}

/// Chi-square test that `cell(sample)` in [0, 1)^2 is uniform.
double p_value(const std::function<Vec2(const Vec2&)>& cell) {
    constexpr int kSide = 16;
    std::vector<double> counts(kSide * kSide), expected(kSide * kSide, double(kSamples) / (kSide * kSide));
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Vec2 c = glm::clamp(cell(draw(i)), 0.0f, 0.9999999f) * float(kSide);
        ++counts[static_cast<std::size_t>(c.y) * kSide + static_cast<std::size_t>(c.x)];
    }
    return test::chi_square_test(counts, expected);
}

float azimuth(const Vec3& w) {
    return std::atan2(w.y, w.x) / (2 * kPi) + 0.5f;
}

TEST(Sampling, CosineAndSineOfTurnsAreRightToTheLastBitButOne) {
    for (int i = 0; i <= 1 << 16; ++i) {
        const float turns = std::ldexp(static_cast<float>(i), -16);
        const Vec2 w = cos_sin_turns(turns);
        const double angle = 2 * std::numbers::pi * turns;
        EXPECT_NEAR(w.x, std::cos(angle), 1.5e-7) << turns;
        EXPECT_NEAR(w.y, std::sin(angle), 1.5e-7) << turns;
    }
}

TEST(Sampling, DensitiesAreWhatTheyClaim) {
    const double level = test::sidak(0.01, 6);
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec2 d = sample_concentric_disk(u);
                  return Vec2(glm::dot(d, d), azimuth(Vec3(d, 0)));
              }),
              level);
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec3 w = sample_cosine_hemisphere(u);
                  return Vec2(w.z * w.z, azimuth(w));
              }),
              level);
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec3 w = sample_uniform_sphere(u);
                  return Vec2((w.z + 1) / 2, azimuth(w));
              }),
              level);
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec3 w = sample_uniform_hemisphere(u);
                  return Vec2(w.z, azimuth(w));
              }),
              level);
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec3 w = sample_uniform_cone(u, 0.1f);
                  return Vec2((1 - w.z) / 0.1f, azimuth(w));
              }),
              level);
    // A uniform (b1, b2) with b1 + b2 <= 1: the sum's square is uniform, and the share of b1 in the sum.
    EXPECT_GT(p_value([](const Vec2& u) {
                  const Vec2 b = sample_uniform_triangle(u);
                  const float sum = b.x + b.y;
                  return Vec2(sum * sum, b.x / sum);
              }),
              level);
}

TEST(Sampling, ExtremeNumbersGiveUnitDirectionsAndPointsInside) {
    for (const float x : {0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f}) {
        for (const float y : {0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f}) {
            const Vec2 u(x, y);
            EXPECT_LE(glm::length(sample_concentric_disk(u)), 1 + 1e-6f);
            for (const Vec3& w : {sample_cosine_hemisphere(u), sample_uniform_hemisphere(u), sample_uniform_sphere(u),
                                  sample_uniform_cone(u, 1e-12f)}) {
                EXPECT_NEAR(glm::length(w), 1, 1e-6);
            }
            EXPECT_GE(sample_cosine_hemisphere(u).z, 0);
            const Vec2 b = sample_uniform_triangle(u);
            EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1);
        }
    }
}

TEST(Sampling, TinyConesKeepTheirPrecision) {
    // sin(theta) against long double, for half angles down to 1e-6.
    for (const double angle : {1e-6, 1e-4, 0.01, 1.0, 1.5}) {
        const auto one_minus_cos = static_cast<float>(2 * std::pow(std::sin(angle / 2), 2));
        for (const float u : {0.1f, 0.5f, 0.9f}) {
            const Vec3 w = sample_uniform_cone(Vec2(0.5f + u / 2, 0.5f), one_minus_cos);
            const long double x = static_cast<long double>(u) * u * one_minus_cos;
            EXPECT_NEAR(std::hypot(w.x, w.y) / static_cast<double>(std::sqrt(x * (2 - x))), 1, 1e-6);
        }
        EXPECT_NEAR(uniform_cone_pdf(one_minus_cos) * (2 * M_PI * 2 * std::pow(std::sin(angle / 2), 2)), 1, 1e-6);
    }
}

TEST(Sampling, HeuristicsSumToOne) {
    for (const float a : {1e-30f, 1e-3f, 1.0f, 7.0f, 1e20f, 3e38f}) {
        for (const float b : {1e-30f, 0.5f, 1.0f, 1e20f, 3e38f}) {
            EXPECT_NEAR(balance_heuristic(a, b) + balance_heuristic(b, a), 1, 1e-6);
            EXPECT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1, 1e-6);
        }
        EXPECT_EQ(power_heuristic(a, 0), 1);
        EXPECT_EQ(power_heuristic(0, a), 0);
        EXPECT_EQ(balance_heuristic(0, a), 0);
    }
    EXPECT_FLOAT_EQ(balance_heuristic(3, 1), 0.75f);
    EXPECT_FLOAT_EQ(power_heuristic(3, 1), 0.9f);
    EXPECT_EQ(power_heuristic(0, 0), 0);
}

constexpr std::array<float, 7> kWeights{1, 0, 5, 0.001f, 3, 0, 2};

TEST(AliasTable, FrequenciesFollowTheWeights) {
    const AliasTable table(kWeights);
    std::vector<double> counts(kWeights.size()), expected;
    double total = 0;
    for (const float w : kWeights) total += w;
    for (const float w : kWeights) expected.push_back(w / total * kSamples);
    float sum = 0;
    for (std::uint32_t i = 0; i < kWeights.size(); ++i) {
        EXPECT_FLOAT_EQ(table.probability(i), static_cast<float>(kWeights[i] / total));
        sum += table.probability(i);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const AliasTable::Draw d = table.draw(draw(i).x);
        ASSERT_GT(kWeights[d.index], 0);
        ASSERT_EQ(d.probability, table.probability(d.index));
        ++counts[d.index];
    }
    EXPECT_GT(test::chi_square_test(counts, expected), 1e-3);
}

TEST(AliasTable, RemainderIsUniformForEachIndex) {
    const AliasTable table(kWeights);
    std::vector<std::vector<double>> counts(kWeights.size(), std::vector<double>(10));
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const AliasTable::Draw d = table.draw(draw(i).x);
        ASSERT_TRUE(d.remainder >= 0 && d.remainder < 1);
        ++counts[d.index][static_cast<std::size_t>(d.remainder * 10)];
    }
    for (std::size_t i = 0; i < kWeights.size(); ++i) {
        if (kWeights[i] < 1) continue;
        const std::vector<double> expected(10, kWeights[i] / 11.001 * kSamples / 10);
        EXPECT_GT(test::chi_square_test(counts[i], expected), test::sidak(1e-3, 4)) << i;
    }
}

TEST(AliasTable, ManyWeightsAndExtremes) {
    std::vector<float> weights;
    for (std::uint32_t i = 0; i < 1000; ++i) weights.push_back(i % 3 == 0 ? 0 : std::pow(draw(i).x, 8.0f));
    weights.push_back(NAN);
    weights.push_back(-1);
    weights.push_back(INFINITY);
    const AliasTable table(weights);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const std::uint32_t index = table.draw(draw(i).y).index;
        ASSERT_LT(index, 1000u);
        ASSERT_GT(weights[index], 0);
    }
    for (const float u : {0.0f, 1 - 0x1p-24f}) EXPECT_GT(weights[table.draw(u).index], 0);
    EXPECT_TRUE(AliasTable(std::array{0.0f, -1.0f, NAN}).empty());
    EXPECT_TRUE(AliasTable().empty());
    EXPECT_EQ(AliasTable().memory_bytes(), 0u);
    EXPECT_EQ(AliasTable(std::array{3e38f, 3e38f}).probability(0), 0.5f) << "the sum exceeds float";
}

TEST(Distribution1D, InvertsTheCumulativeSum) {
    const Distribution1D d(kWeights);
    EXPECT_NEAR(d.total(), 11.001, 1e-6);
    double start = 0;
    for (std::uint32_t i = 0; i < kWeights.size(); ++i) {
        EXPECT_NEAR(d.probability(i), kWeights[i] / 11.001, 1e-7);
        if (kWeights[i] >= 1) {
            const auto middle = static_cast<float>((start + kWeights[i] / 2) / 11.001);
            EXPECT_EQ(d.draw(middle).cell, i);
            EXPECT_NEAR(d.draw(middle).offset, 0.5, 1e-5);
        }
        start += kWeights[i];
    }
    for (const float u : {0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f}) {
        const auto drawn = d.draw(u);
        EXPECT_GT(drawn.probability, 0);
        EXPECT_TRUE(drawn.offset >= 0 && drawn.offset < 1);
    }
    EXPECT_EQ(Distribution1D(std::array{0.0f, 0.0f}).total(), 0);
}

TEST(Distribution2D, FrequenciesFollowTheWeights) {
    const std::array<float, 12> weights{1, 2, 0, 4, 0, 0, 0, 0, 3, 0, 1, 7};
    const Distribution2D d(weights, 4);
    std::vector<double> counts(weights.size()), expected;
    double sum = 0;
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
        expected.push_back(weights[i] / 18.0 * kSamples);
        EXPECT_NEAR(d.probability(i % 4, i / 4), weights[i] / 18, 1e-6);
        sum += d.probability(i % 4, i / 4);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const auto drawn = d.draw(draw(i));
        ++counts[drawn.row * 4 + drawn.column];
        ASSERT_FLOAT_EQ(drawn.probability, d.probability(drawn.column, drawn.row));
    }
    EXPECT_GT(test::chi_square_test(counts, expected), 1e-3);
}

}  // namespace
}  // namespace rayuela
