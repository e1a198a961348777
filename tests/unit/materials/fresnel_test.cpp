#include "core/materials/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayuela {
namespace {

/// Textbook form in long double, from the angles' cosines.
long double reference(long double cos_i, long double eta) {
    const long double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const long double cos_t = std::sqrt(1 - sin2_t);
    const long double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const long double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return (s * s + p * p) / 2;
}

TEST(Fresnel, AgreesWithLongDouble) {
    for (const float eta : {1e-3f, 0.4f, 1 / 1.5f, 0.9f, 1.1f, 1.33f, 1.5f, 2.4f, 10.0f, 1000.0f}) {
        for (int i = 0; i <= 1000; ++i) {
            const float cosine = static_cast<float>(i) / 1000;
            const long double exact = reference(cosine, eta);
            const double value = fresnel_dielectric(cosine, eta);
            ASSERT_GE(value, 0);
            ASSERT_LE(value, 1);
            // Just inside the critical angle R falls from 1 with infinite slope: there rounding of cos^2 shows.
            const long double g2 =
                1 - (1 - static_cast<long double>(cosine) * cosine) / (static_cast<long double>(eta) * eta);
            const long double tolerance = 2e-6L + 4e-7L / std::sqrt(std::abs(g2) + 1e-7L);
            ASSERT_NEAR(static_cast<double>(value), static_cast<double>(exact), static_cast<double>(tolerance))
                << cosine << " " << eta;
        }
    }
}

TEST(Fresnel, KeepsItsPrecisionForAlmostEqualMedia) {
    for (const float eta : {1 + 0x1p-23f, 1 - 0x1p-23f, 1 + 1e-5f, 1 + 1e-3f}) {
        for (const float cosine : {0.3f, 0.6f, 1.0f}) {
            const auto exact = static_cast<double>(reference(cosine, eta));
            EXPECT_NEAR(fresnel_dielectric(cosine, eta), exact, 2e-3 * exact) << eta << " " << cosine;
        }
    }
    for (const float cosine : {0.0f, 1e-4f, 0.5f, 1.0f}) EXPECT_EQ(fresnel_dielectric(cosine, 1), 0);
}

TEST(Fresnel, KnownValues) {
    EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04, 1e-7);
    EXPECT_NEAR(fresnel_normal(1.5f), 0.04, 1e-7);
    EXPECT_NEAR(fresnel_normal(1 / 1.5f), 0.04, 1e-7);
    EXPECT_DOUBLE_EQ(fresnel_dielectric(0, 1.5f), 1);
    const float critical = std::sqrt(1 - 1 / (1.5f * 1.5f));  // of light inside glass
    EXPECT_EQ(fresnel_dielectric(critical - 1e-3f, 1 / 1.5f), 1);
    EXPECT_LT(fresnel_dielectric(critical + 1e-3f, 1 / 1.5f), 1);
    // Brewster's angle, tan = 1.5: p vanishes, s is ((1.5^2 - 1) / (1.5^2 + 1))^2.
    EXPECT_NEAR(fresnel_dielectric(1 / std::sqrt(1 + 2.25f), 1.5f), 0.5 * std::pow(1.25 / 3.25, 2), 1e-6);
}

TEST(Fresnel, BothSidesReflectAlike) {
    for (const float cos_i : {0.1f, 0.5f, 0.9f}) {
        const float cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / 2.25f);
        EXPECT_NEAR(fresnel_dielectric(cos_i, 1.5f), fresnel_dielectric(cos_t, 1 / 1.5f), 2e-6);
    }
}

}  // namespace
}  // namespace rayuela
