#include "core/lights/environment_light.h"

#include "core/lights/environment_distribution.h"
#include "core/lights/light_table.h"
#include "core/math/sampler.h"
#include "core/math/sampling.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <numbers>

namespace rayuela {
namespace {

/// Pixels from `value(x, y)`.
template <typename F>
ImageEnvironment panorama(int width, int height, const F& value, float rotation = 0) {
    Image image{width, height, {}, ""};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.pixels.emplace_back(Color(value(x, y)), 1);
    }
    return {"", std::make_shared<const Image>(std::move(image)), 1, rotation};
}

/// Bright in one pixel of an otherwise dim image.
ImageEnvironment sun(int width, int height, int sun_x, int sun_y, float rotation = 0) {
    return panorama(
        width, height, [=](int x, int y) { return x == sun_x && y == sun_y ? 1000.0f : 0.1f; }, rotation);
}

TEST(EnvironmentLight, ConstantGradientAndNone) {
    EXPECT_TRUE(EnvironmentLight(NoEnvironment{}).is_black());
    EXPECT_EQ(EnvironmentLight(NoEnvironment{}).radiance(Vec3(0, 1, 0)), Color(0));
    const EnvironmentLight constant(ConstantEnvironment{Color(1, 2, 3)});
    EXPECT_EQ(constant.radiance(glm::normalize(Vec3(1, -2, 3))), Color(1, 2, 3));
    EXPECT_FALSE(constant.is_black());
    const EnvironmentLight gradient(GradientEnvironment{Color(1), Color(0.5f, 0.7f, 1)});
    EXPECT_EQ(gradient.radiance(Vec3(0, 1, 0)), Color(0.5f, 0.7f, 1));
    EXPECT_EQ(gradient.radiance(Vec3(0, -1, 0)), Color(1));
    EXPECT_NEAR(gradient.radiance(Vec3(1, 0, 0)).x, 0.75, 1e-6);
    EXPECT_TRUE(EnvironmentLight(ImageEnvironment{}).is_black()) << "an image that is not there";
}

TEST(EnvironmentLight, ImageCentreLiesTowardsMinusZ) {
    // Columns: centres at u = 1/8, 3/8, 5/8, 7/8; the middle of the image is the border between the second and third.
    const EnvironmentLight light(panorama(4, 2, [](int x, int y) { return float(x + 10 * y); }));
    const float s = std::sqrt(0.5f);
    EXPECT_NEAR(light.image_position(Vec3(0, 0, -1)).x, 0.5, 1e-6);
    EXPECT_NEAR(light.image_position(Vec3(1, 0, 0)).x, 0.75, 1e-6) << "u grows to the right";
    EXPECT_NEAR(light.image_position(Vec3(-1, 0, 0)).x, 0.25, 1e-6);
    EXPECT_NEAR(light.image_position(Vec3(0, 1, 0)).y, 0, 1e-6) << "the first row is the top";
    EXPECT_NEAR(light.image_position(Vec3(0, -1, 0)).y, 1, 1e-6);
    // Azimuth 45 degrees right of -z is u = 5/8, the centre of the third column; 45 degrees up the centre of the first row.
    EXPECT_NEAR(light.radiance(Vec3(0.5f, s, -0.5f)).x, 2, 1e-4);
    EXPECT_NEAR(light.radiance(Vec3(-0.5f, -s, -0.5f)).x, 11, 1e-4);
    EXPECT_NEAR(light.radiance(Vec3(0, s, s)).x, 1.5, 1e-4) << "half way across the seam, between 0 and 3";
}

TEST(EnvironmentLight, RotationTurnsThePanoramaAboutY) {
    const auto value = [](int x, int y) { return float(x + 10 * y); };
    const EnvironmentLight still(panorama(8, 4, value)), turned(panorama(8, 4, value, 90));
    // Turned by 90 degrees about +y what was at -z is at -x.
    for (const Vec3& w : {Vec3(0, 0, -1), Vec3(0.6f, 0.64f, 0.48f), Vec3(-0.48f, -0.6f, 0.64f)}) {
        EXPECT_NEAR(turned.radiance(Vec3(w.z, w.y, -w.x)).x, still.radiance(w).x, 1e-4);
    }
    EXPECT_LT(glm::length(turned.direction(Vec2(0.5f)) - Vec3(-1, 0, 0)), 1e-6f);
}

TEST(EnvironmentLight, DirectionInvertsImagePosition) {
    const EnvironmentLight light(sun(4, 2, 0, 0, 37));
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const Vec3 w = sample_uniform_sphere(Sampler(SamplerKind::independent, 0, 0, i).get_2d(0));
        EXPECT_LT(glm::length(light.direction(light.image_position(w)) - w), 2e-6f);
    }
}

TEST(EnvironmentDistribution, DensityIntegratesToOne) {
    for (const ImageEnvironment& e :
         {sun(16, 8, 3, 2), sun(16, 8, 15, 0, 30), sun(7, 5, 0, 4), sun(1, 1, 0, 0), sun(3000, 1500, 100, 700)}) {
        const EnvironmentDistribution distribution{EnvironmentLight(e)};
        // Exactly, cell by cell: pdf times the solid angle of a grid finer than, and aligned with, the pixels.
        const EnvironmentLight light(e);
        const int columns = e.image->width > 100 ? 1500 : e.image->width * 2;
        const int rows = e.image->height > 100 ? 750 : e.image->height * 2;
        double sum = 0;
        for (int y = 0; y < rows; ++y) {
            const double step = std::numbers::pi / rows;
            const double solid_angle = 2 * std::numbers::pi / columns * (std::cos(y * step) - std::cos((y + 1) * step));
            for (int x = 0; x < columns; ++x) {
                const Vec2 position((float(x) + 0.5f) / float(columns), (float(y) + 0.5f) / float(rows));
                sum += distribution.pdf(light.direction(position)) * solid_angle;
            }
        }
        EXPECT_NEAR(sum, 1, 1e-3) << e.image->width;
    }
}

TEST(EnvironmentDistribution, SamplesCarryTheirDensityAndRadiance) {
    const ImageEnvironment e = sun(16, 8, 5, 2, 75);
    const EnvironmentLight light(e);
    const EnvironmentDistribution distribution(light);
    int bright = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const auto s = distribution.sample(Sampler(SamplerKind::sobol, 0, 0, i).get_2d(0));
        ASSERT_TRUE(s);
        ASSERT_NEAR(glm::length(s->wi), 1, 1e-5);
        ASSERT_EQ(s->distance, kInfinity);
        ASSERT_NEAR(s->radiance.x, light.radiance(s->wi).x, 1e-3);
        const Vec2 cell = light.image_position(s->wi) * Vec2(16, 8);
        const Vec2 inside = cell - glm::floor(cell);
        if (std::min({inside.x, inside.y, 1 - inside.x, 1 - inside.y}) > 1e-3f) {
            ASSERT_NEAR(distribution.pdf(s->wi) / s->pdf, 1, 1e-4);
        }
        bright += s->radiance.x > 1;
    }
    // The sun's pixel, its neighbours (1/6 of it each, half dark) and the corners (1/36 each, three quarters dark).
    const double centre = 0.5625;
    EXPECT_NEAR(bright / 2000.0, centre * (1 + 4 / 6.0 / 2 + 4 / 36.0 / 4), 0.02);
}

TEST(EnvironmentDistribution, IrradianceAgreesWithQuadrature) {
    for (const ImageEnvironment& e :
         {sun(16, 8, 5, 2, 20), sun(16, 8, 0, 0), panorama(8, 4, [](int x, int) { return float(x); })}) {
        const EnvironmentLight light(e);
        const Vec3 n = glm::normalize(Vec3(0.3f, 1, 0.2f));
        double expected = 0;
        const int rows = 512, columns = 1024;
        for (int y = 0; y < rows; ++y) {
            const double theta = (y + 0.5) * std::numbers::pi / rows;
            for (int x = 0; x < columns; ++x) {
                const Vec3 w = light.direction({(float(x) + 0.5f) / columns, (float(y) + 0.5f) / rows});
                expected += light.radiance(w).x * std::max(0.0f, glm::dot(n, w)) * std::sin(theta);
            }
        }
        expected *= 2 * std::numbers::pi * std::numbers::pi / (double(rows) * columns);
        const EnvironmentDistribution distribution(light);
        test::Moments estimate;
        for (std::uint32_t i = 0; i < 20'000; ++i) {
            const auto s = distribution.sample(Sampler(SamplerKind::independent, 0, 0, i).get_2d(0));
            estimate.add(s ? double(s->radiance.x * std::max(0.0f, glm::dot(n, s->wi)) / s->pdf) : 0);
        }
        EXPECT_NEAR(estimate.mean(), expected, 4 * estimate.error() + 1e-3 * expected);
        EXPECT_LT(estimate.error(), 0.02 * expected);
    }
}

TEST(EnvironmentDistribution, ExtremeNumbersAndBadPixels) {
    const EnvironmentDistribution distribution{EnvironmentLight(panorama(8, 6, [](int x, int y) {
        return x == 1 ? NAN : y == 2 ? -1.0f : x == 0 ? INFINITY : 1.0f;
    }))};
    ASSERT_FALSE(distribution.empty());
    for (const float x : {0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f}) {
        for (const float y : {0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f}) {
            const auto s = distribution.sample(Vec2(x, y));
            EXPECT_TRUE(!s || (is_finite(s->wi) && std::isfinite(s->pdf) && s->pdf > 0));
        }
    }
    EXPECT_EQ(distribution.pdf(Vec3(NAN)), 0);
    EXPECT_TRUE(std::isnan(EnvironmentLight(sun(4, 2, 0, 0)).radiance(Vec3(NAN)).x)) << "to be rejected and counted";
    EXPECT_TRUE(EnvironmentDistribution{EnvironmentLight(panorama(4, 2, [](int, int) { return 0.0f; }))}.empty());
}

TEST(LightTable, SharesSamplesBetweenPanoramaAndLamps) {
    const std::vector<GeometryInstance> instances{{Sphere{Vec3(0, 0, 5), 1}, {}}};
    const Material lamp = Emitter{};
    const std::vector<const Material*> materials{&lamp};
    const ImageEnvironment e = sun(16, 8, 5, 2);
    const LightTable both(instances, materials, e), alone({}, {}, e);
    EXPECT_EQ(both.size(), 2u);
    EXPECT_EQ(alone.size(), 1u);
    EXPECT_FALSE(alone.empty());
    const Vec3 w = glm::normalize(Vec3(0.3f, 0.5f, -0.2f));
    EXPECT_FLOAT_EQ(both.environment_pdf(w), 0.5f * alone.environment_pdf(w));
    int infinite = 0;
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const Sampler sampler(SamplerKind::sobol, 0, 0, i);
        const auto s = both.sample({Vec3(0)}, sampler.get_2d(1));
        ASSERT_TRUE(s);
        infinite += s->distance == kInfinity;
        if (s->distance == kInfinity) {
            EXPECT_EQ(shadow_ray(Vec3(1), *s).t_max, kInfinity);
            EXPECT_NEAR(s->pdf / both.environment_pdf(s->wi), 1, 1e-2);
        }
    }
    EXPECT_EQ(infinite, 512);
}

}  // namespace
}  // namespace rayuela
