#include "core/materials/value.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

/// Upper row: 1, 2; lower row: 3, 4 (in red).
Image four_pixels() {
    Image image{2, 2, {Vec4(1), Vec4(2), Vec4(3), Vec4(4)}, ""};
    return image;
}

TEST(Texture, OriginIsTheLowerLeftCorner) {
    const Image image = four_pixels();
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0.25f, 0.25f)).x, 3);
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0.75f, 0.25f)).x, 4);
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0.25f, 0.75f)).x, 1);
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0.75f, 0.75f)).x, 2);
}

TEST(Texture, InterpolatesAndRepeats) {
    const Image image = four_pixels();
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0.5f, 0.5f)).x, 2.5f);
    EXPECT_FLOAT_EQ(sample_texture(image, Vec2(0, 0.75f)).x, 1.5f) << "half way across the seam";
    for (const Vec2& uv : {Vec2(0.1f, 0.9f), Vec2(0.6f, 0.3f)}) {
        EXPECT_NEAR(sample_texture(image, uv).x, sample_texture(image, uv + Vec2(3, -2)).x, 1e-5);
    }
}

TEST(Texture, BadInputGivesAPixel) {
    const Image image = four_pixels();
    for (const float x : {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, -0x1p-149f}) {
        const float value = sample_texture(image, Vec2(x, x)).x;
        EXPECT_TRUE(value >= 1 && value <= 4) << x;
    }
    EXPECT_EQ(sample_texture(Image{}, Vec2(0.5f)), Vec4(0));
}

TEST(Texture, MultipliesTheValue) {
    const auto image = std::make_shared<const Image>(Image{1, 1, {Vec4(0.5f, 0.25f, 0.125f, 1)}, ""});
    EXPECT_EQ(evaluate(ColorValue{Color(2), image}, Vec2(0.3f)), Color(1, 0.5f, 0.25f));
    EXPECT_EQ(evaluate(FloatValue{2, image, 2}, Vec2(0.3f)), 0.25f);
    EXPECT_EQ(evaluate(FloatValue{2, nullptr, 2}, Vec2(0.3f)), 2);
}

}  // namespace
}  // namespace rayuela
