#include "core/render/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace rayuela {
namespace {

using Pixels = std::vector<Vec4>;

Pixels grey(std::size_t n, float value) {
    return Pixels(n, Vec4(value, value, value, 1));
}

TEST(ImageError, OfTheReferenceItselfIsNothing) {
    const Pixels a = grey(10, 0.5f);
    const ImageError error = image_error(a, {a, a});
    EXPECT_EQ(error.rel_mse, 0);
    EXPECT_EQ(error.rel_mse_trimmed, 0);
    EXPECT_EQ(error.rmse, 0);
    EXPECT_EQ(error.mape, 0);
    EXPECT_EQ(error.worst_mille, 0);
    EXPECT_EQ(error.mean_ratio, 1);
    EXPECT_EQ(error.nonfinite, 0u);
}

TEST(ImageError, OfAConstantOffset) {
    // I = 1.25, R = 1: every relative square is 0.0625 / 1.01.
    const Pixels a = grey(64, 1), image = grey(64, 1.25f);
    const ImageError error = image_error(image, {a, a});
    EXPECT_NEAR(error.rel_mse, 0.0625 / 1.01, 1e-12);
    EXPECT_NEAR(error.rel_mse_trimmed, 0.0625 / 1.01, 1e-12);
    EXPECT_NEAR(error.rmse, 0.25, 1e-12);
    EXPECT_NEAR(error.mape, 0.25 / 1.01, 1e-12);
    EXPECT_NEAR(error.worst_mille, 0.0625 / 1.01, 1e-12);
    EXPECT_NEAR(error.mean_ratio, 1.25, 1e-12);
}

TEST(ImageError, NoiseOfTheReferenceDropsOut) {
    // A and B err by +-d in all four combinations of signs: I = the truth has no error in the mean, though |I - R| is not 0.
    const float d = 0.125f;
    Pixels a, b;
    for (const float sa : {-d, d}) {
        for (const float sb : {-d, d}) {
            a.emplace_back(Vec3(1 + sa), 1);
            b.emplace_back(Vec3(1 + sb), 1);
        }
    }
    const ImageError error = image_error(grey(4, 1), {a, b});
    EXPECT_EQ(error.rmse, 0);
    EXPECT_GT(error.mape, 0);
    EXPECT_DOUBLE_EQ(error.mean_ratio, 1);
}

TEST(ImageError, TrimmingTakesTheWorstMille) {
    // Of 2000 pixels two are trimmed: both outliers, so that the third worst is what the percentile says.
    const Pixels a = grey(2000, 0);
    Pixels image = a;
    image[7] = Vec4(10, 10, 10, 1);
    image[1900] = Vec4(0, 0, 30, 1);
    image[3] = Vec4(0.1f, 0.1f, 0.1f, 1);
    const ImageError error = image_error(image, {a, a});
    const double third = double(0.1f) * double(0.1f) / 0.01;
    EXPECT_NEAR(error.rel_mse, (100 / 0.01 + 900 / 3.0 / 0.01 + third) / 2000, 1e-6);
    EXPECT_NEAR(error.worst_mille, third, 1e-12);
    EXPECT_NEAR(error.rel_mse_trimmed, third / 1998, 1e-12);
}

TEST(ImageError, PixelsThatAreNoNumberAreBlackAndCounted) {
    const Pixels a = grey(4, 1);
    Pixels image = a;
    image[0].x = std::numeric_limits<float>::quiet_NaN();
    image[3].z = std::numeric_limits<float>::infinity();
    const ImageError error = image_error(image, {a, a});
    EXPECT_EQ(error.nonfinite, 2u);
    EXPECT_NEAR(error.rel_mse, 0.5 / 1.01, 1e-12);
    EXPECT_NEAR(error.mean_ratio, 0.5, 1e-12);
}

TEST(ImageError, UncertaintyOfTheReferencesMean) {
    // |A - B| = 0.2 in every pixel: each is uncertain by 0.1, the mean of n that are independent by 0.1 / sqrt(n), relative
    // to 1. The mean of those that all err alike is as uncertain as each of them.
    Pixels a = grey(100, 1.1f), b = grey(100, 0.9f);
    EXPECT_NEAR(mean_ratio_uncertainty({a, b}), 0.1, 1e-7);
    for (std::size_t i = 0; i < a.size(); i += 2) std::swap(a[i], b[i]);
    EXPECT_NEAR(mean_ratio_uncertainty({a, b}), 0.01, 1e-7);
}

}  // namespace
}  // namespace rayuela
