#include "core/render/film.h"

#include "core/math/sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rayuela {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Film, MeanIsThatOfTheSamples) {
    Film film(2, 1);
    film.add(0, 0, Color(1, 2, 3));
    film.add(0, 1, Color(3, 2, 1));
    film.add(0, 2, Color(2, 5, 8));
    EXPECT_EQ(film.mean(0), Vec3d(2, 3, 4));
    EXPECT_EQ(film.count(0), 3u);
    EXPECT_EQ(film.mean(1), Vec3d(0));
    const Image image = film.image();
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 1);
    EXPECT_EQ(image.at(0, 0), Vec4(2, 3, 4, 1));
    EXPECT_EQ(image.at(1, 0), Vec4(0, 0, 0, 1));
}

TEST(Film, RejectsAndCountsByCause) {
    Film film(1, 1);
    film.add(0, 0, Color(1));
    film.add(0, 1, Color(0, kNan, 0));
    film.add(0, 2, Color(kInfinity, 0, 0));
    film.add(0, 3, Color(0, 0, -1e-30f));
    film.add(0, 4, Color(-kInfinity, 0, 0));
    film.add(0, 5, Color(-1, kNan, kInfinity));
    film.add(0, 6, Color(3));
    EXPECT_THAT(film.rejected(), testing::ElementsAre(2, 2, 1));
    EXPECT_EQ(film.count(0), 2u);
    EXPECT_EQ(film.mean(0), Vec3d(2));
    film.clear_rejected();
    EXPECT_THAT(film.rejected(), testing::ElementsAre(0, 0, 0));
}

TEST(Film, ShowsTheMeanOfSamplesPlusTheMeanOfRounds) {
    Film film(2, 1);
    film.add(0, 0, Color(1));
    film.add(0, 1, Color(3));
    film.splat(0, 0, Color(8));
    film.splat(1, 0, Color(4));
    film.splat(0, 0, Color(NAN));
    film.end_round(0);
    EXPECT_EQ(film.mean(0), Vec3d(10));
    film.splat(0, 1, Color(2));
    film.splat(0, 1, Color(2));
    film.end_round(1);
    film.end_round(2);
    EXPECT_EQ(film.rounds(), 3u);
    EXPECT_EQ(film.mean(0), Vec3d(2 + 12 / 3.0));
    EXPECT_EQ(film.mean(1), Vec3d(4 / 3.0));
    EXPECT_EQ(film.rejected()[0], 1u);
    film.clear(0);
    film.clear_splats();
    EXPECT_EQ(film.mean(0), Vec3d(0));
    EXPECT_EQ(film.rounds(), 0u);
}

TEST(Film, RelativeErrorSeesTheRounds) {
    // Two halves that differ by 2 in one pixel: an error of (2 / 2)^2 over the mean's square + 0.01.
    Film film(1, 1);
    film.add(0, 0, Color(1));
    film.add(0, 1, Color(1));
    film.splat(0, 0, Color(2));
    film.end_round(0);
    EXPECT_EQ(film.relative_error(), 0) << "half of the rounds are missing";
    film.end_round(1);
    EXPECT_NEAR(film.relative_error(), 1 / (4 + 0.01), 1e-12);
}

TEST(Film, NegativeZeroIsNotNegative) {
    EXPECT_FALSE(rejection(Color(-0.0f)));
}

TEST(Film, ClearForgetsOnePixel) {
    Film film(2, 1);
    film.add(0, 0, Color(7));
    film.add(1, 0, Color(7));
    film.clear(0);
    EXPECT_EQ(film.count(0), 0u);
    EXPECT_EQ(film.mean(0), Vec3d(0));
    EXPECT_EQ(film.mean(1), Vec3d(7));
}

/// A naive float sum of these is wrong by 1e-4 and more.
TEST(Film, LongSumsKeepTheirPrecision) {
    Film film(1, 1);
    film.add(0, 0, Color(1e6f));
    constexpr std::uint32_t kSamples = 3'000'000;
    for (std::uint32_t i = 1; i < kSamples; ++i) film.add(0, i, Color(0.01f));
    const double expected = (1e6 + (kSamples - 1) * static_cast<double>(0.01f)) / kSamples;
    EXPECT_NEAR(film.mean(0).x / expected, 1, 1e-12);
}

/// The estimate, over many pixels, against the variance that the samples were drawn with.
TEST(Film, EstimatedErrorsAreUnbiased) {
    constexpr int kSide = 64, kSamples = 10;
    Film film(kSide, kSide);
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> uniform(0, 2);
    double variance_sum = 0;
    for (std::size_t pixel = 0; pixel < kSide * kSide; ++pixel) {
        for (std::uint32_t i = 0; i < kSamples; ++i) film.add(pixel, i, Color(uniform(generator)));
        variance_sum += film.variance_of_mean(pixel);
    }
    const double variance_of_mean = (4.0 / 12) / kSamples;
    EXPECT_NEAR(variance_sum / (kSide * kSide) / variance_of_mean, 1, 0.03);
    // 1 / (mean^2 + 0.01) varies with the mean: its expectation is 1 + 3 Var(mean) to second order.
    EXPECT_NEAR(film.relative_error() / (variance_of_mean / 1.01), 1 + 3 * variance_of_mean, 0.08);
}

TEST(Film, HalvesTakeTurnsInBlocks) {
    std::string halves;
    for (std::uint32_t i = 0; i < 16; ++i) halves += sample_half(i) ? 'B' : 'A';
    EXPECT_EQ(halves, "ABABAABBAAAABBBB");
}

/// On a smooth function a low-discrepancy sequence errs far less than independent samples, and the estimate must say so:
/// within a factor of a few of the true error, never below it.
TEST(Film, EstimatedErrorKnowsStratification) {
    constexpr std::uint32_t kPixels = 1024, kSamples = 64;
    Film film(kPixels, 1);
    double error = 0;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            const Vec2 u = Sampler(SamplerKind::sobol, 0, pixel, i).get_2d(0);
            film.add(pixel, i, Color(u.x + u.y));
        }
        error += (film.mean(pixel).x - 1) * (film.mean(pixel).x - 1) / 1.01 / kPixels;
    }
    const double independent = (2.0 / 12) / kSamples / 1.01;
    EXPECT_LT(error, independent / 20);
    EXPECT_LT(film.relative_error(), independent / 5);
    EXPECT_GT(film.relative_error(), error);
}

TEST(Film, ErrorIsUnknownWhileAHalfIsEmpty) {
    Film film(2, 1);
    film.add(0, 0, Color(1));
    film.add(0, 1, Color(2));
    film.add(1, 0, Color(1));
    EXPECT_EQ(film.relative_error(), 0);
    film.add(1, 1, Color(1));
    // First pixel: (1 - 2)^2 / 4 over 1.5^2 + 0.01; the second has no difference.
    EXPECT_NEAR(film.relative_error(), 0.5 * 0.25 / 2.26, 1e-15);
}

}  // namespace
}  // namespace rayuela
