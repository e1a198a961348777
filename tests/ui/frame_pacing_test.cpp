#include "ui/frame_pacing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayuela {
namespace {

TEST(FramePacing, NothingNewIsAnEndlessSleep) {
    FrameTiming timing;
    timing.now = 100;
    timing.last_draw = 99;
    EXPECT_TRUE(std::isinf(seconds_to_next_frame(timing)));
}

TEST(FramePacing, InputIsDrawnAtOnce) {
    FrameTiming timing;
    timing.now = timing.last_input = 100;
    timing.last_draw = 90;
    timing.frames_since_input = 0;
    EXPECT_EQ(seconds_to_next_frame(timing), 0);
}

TEST(FramePacing, HoweverSlowAFrameIsAClickIsFollowedByMore) {
    FrameTiming timing;
    timing.last_input = 100;
    timing.last_draw = 100;
    timing.frames_since_input = 1;
    timing.now = timing.last_input + 5;
    EXPECT_EQ(seconds_to_next_frame(timing), 0);
}

TEST(FramePacing, ANewImageIsDrawnWithinTheIntervalAndNoSooner) {
    FrameTiming timing;
    timing.now = 100;
    timing.last_draw = 99.99;
    timing.published = true;
    timing.draw_cost = 0.02;
    const double wait = seconds_to_next_frame(timing);
    EXPECT_NEAR(wait, publish_interval(0.02, 0) - 0.01, 1e-9);
    timing.now += wait + 1e-9;
    EXPECT_EQ(seconds_to_next_frame(timing), 0);
}

TEST(FramePacing, DrawingTakesASmallShareOfTheTimeAndLessWhenOld) {
    for (const double cost : {1e-4, 2e-3, 0.02, 0.035}) {
        EXPECT_LE(cost / publish_interval(cost, 0), 0.1) << cost;
    }
    EXPECT_LE(publish_interval(1e-4, 0), 1.0 / 60);
    EXPECT_GT(publish_interval(2e-3, 10), publish_interval(2e-3, 0));
    EXPECT_LE(publish_interval(10, 1e6), 0.5);
}

TEST(FramePacing, FlightFollowsWithoutEvents) {
    FrameTiming timing;
    timing.now = 100;
    timing.last_draw = 99.9;
    timing.animating = true;
    EXPECT_EQ(seconds_to_next_frame(timing), 0);
}

TEST(FramePacing, AfterAnInputFramesGoOnUntilTooltipsHaveShown) {
    FrameTiming timing;
    timing.last_input = 100;
    timing.now = timing.last_draw = 100.5;
    EXPECT_LT(seconds_to_next_frame(timing), 0.1);
    timing.now = timing.last_draw = 102;
    EXPECT_TRUE(std::isinf(seconds_to_next_frame(timing)));
}

}  // namespace
}  // namespace rayuela
