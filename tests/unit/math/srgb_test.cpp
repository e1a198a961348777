#include "core/math/srgb.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

TEST(Srgb, HasTheValuesOfTheStandard) {
    EXPECT_EQ(linear_to_srgb(0), 0);
    EXPECT_NEAR(linear_to_srgb(1), 1, 1e-6f);
    EXPECT_NEAR(linear_to_srgb(0.21404114f), 0.5f, 1e-6f);
    EXPECT_NEAR(linear_to_srgb(0.001f), 0.01292f, 1e-7f);
}

TEST(Srgb, TheCurvesAreInverse) {
    for (int i = 0; i <= 512; ++i) {
        const float x = static_cast<float>(i) / 512;
        EXPECT_NEAR(linear_to_srgb(srgb_to_linear(x)), x, 2e-6f);
    }
}

}  // namespace
}  // namespace rayuela
