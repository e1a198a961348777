#include "ui/tone_map.h"

#include <gmock/gmock.h>

#include <limits>

namespace rayuela {
namespace {

using testing::FloatNear;

constexpr ToneMap kAll[] = {ToneMap::linear, ToneMap::aces, ToneMap::agx, ToneMap::filmic, ToneMap::false_color};
constexpr ToneMap kCurves[] = {ToneMap::linear, ToneMap::aces, ToneMap::agx, ToneMap::filmic};

TEST(ToneMap, LinearMultipliesAndClips) {
    EXPECT_EQ(tone_mapped(Color(0.1f, 0.2f, 0.9f), 1, ToneMap::linear), Color(0.2f, 0.4f, 1));
    EXPECT_EQ(tone_mapped(Color(0.8f), -2, ToneMap::linear), Color(0.2f));
}

TEST(ToneMap, IsWithinTheDisplayForEveryRadiance) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const ToneMap tone_map : kAll) {
        for (const float value : {-1.0f, 0.0f, 1e-30f, 0.18f, 1.0f, 1e6f, 3e38f, infinity, nan}) {
            for (const Color& radiance : {Color(value), Color(value, 0, 0.5f)}) {
                const Color shown = tone_mapped(radiance, 2, tone_map);
                for (int channel = 0; channel < 3; ++channel) {
                    EXPECT_GE(shown[channel], 0) << value << " map " << static_cast<int>(tone_map);
                    EXPECT_LE(shown[channel], 1) << value << " map " << static_cast<int>(tone_map);
                }
            }
        }
    }
}

TEST(ToneMap, CurvesKeepBlackAndGreyAndRise) {
    for (const ToneMap tone_map : kCurves) {
        EXPECT_LT(max_component(tone_mapped(Color(0), 0, tone_map)), 2e-3f);
        float before = -1;
        for (float value = 1e-3f; value < 50; value *= 1.1f) {
            const Color shown = tone_mapped(Color(value), 0, tone_map);
            EXPECT_GE(shown.y, before);
            EXPECT_THAT(shown.x, FloatNear(shown.y, 3e-3f)) << "grey stays grey";
            EXPECT_THAT(shown.z, FloatNear(shown.y, 3e-3f));
            before = shown.y;
        }
        EXPECT_GT(before, 0.9f);
    }
}

TEST(ToneMap, FalseColorGoesFromBlueToRed) {
    const Color dark = tone_mapped(Color(0.18f / 64), 0, ToneMap::false_color);
    const Color middle = tone_mapped(Color(0.18f), 0, ToneMap::false_color);
    const Color bright = tone_mapped(Color(0.18f * 32), 0, ToneMap::false_color);
    EXPECT_GT(dark.z, dark.x);
    EXPECT_GT(middle.y, middle.z);
    EXPECT_GT(bright.x, bright.z);
}

TEST(ToneMap, OfAnImageIsThatOfItsPixels) {
    const Image image{2, 1, {Vec4(0.1f, 0.2f, 0.3f, 1), Vec4(4, 5, 6, 1)}, {}};
    const Image shown = tone_mapped(image, 0.5f, ToneMap::aces);
    ASSERT_EQ(shown.pixels.size(), 2u);
    EXPECT_EQ(Color(shown.pixels[0]), tone_mapped(Color(0.1f, 0.2f, 0.3f), 0.5f, ToneMap::aces));
    EXPECT_EQ(shown.pixels[1].w, 1);
}

}  // namespace
}  // namespace rayuela
