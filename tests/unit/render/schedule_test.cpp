#include "core/render/schedule.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

ScheduleState state_1280x720() {
    return {.width = 1280, .height = 720, .quiet_seconds = 0.01, .seconds_per_path = 1e-6, .since_publication = 1};
}

double pass_seconds(const ScheduleState& state, const Pass& pass) {
    return state.seconds_per_path * (state.width / pass.divisor) * (state.height / pass.divisor);
}

TEST(Schedule, FirstPassesAreCoarseAndQuickAtAnySpeed) {
    for (const double seconds_per_path : {2e-7, 1e-6, 4e-6}) {
        ScheduleState state = state_1280x720();
        state.seconds_per_path = seconds_per_path;
        const Pass pass = next_pass(state);
        EXPECT_EQ(pass.kind, Pass::Kind::coarse);
        EXPECT_LE(pass_seconds(state, pass), 0.025);
        EXPECT_GE(pass_seconds(state, pass), 0.005);
    }
}

TEST(Schedule, WaitsBehindThePreviewUntilEditsHaveCeased) {
    ScheduleState state = state_1280x720();
    state.preview_done = true;
    state.quiet_seconds = 0.05;
    const Pass wait = next_pass(state);
    EXPECT_EQ(wait.kind, Pass::Kind::wait);
    EXPECT_GT(wait.wait_seconds, 0);
    state.quiet_seconds += wait.wait_seconds;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
}

TEST(Schedule, NothingFollowsTheFirstImageWhileTreesAreDrafts) {
    ScheduleState state = state_1280x720();
    state.drafted = true;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::coarse);
    state.preview_done = true;
    state.quiet_seconds = 1;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::wait);
    state.paused = true;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::wait) << "a preview is not where one stops";
    state.samples = 1;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::paused);
    state.paused = false;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::wait);
    state.max_samples = 1;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::finished);

    ScheduleState small = state_1280x720();
    small.width = small.height = 16;
    small.drafted = true;
    EXPECT_EQ(next_pass(small).kind, Pass::Kind::full) << "the film is as quick as a preview";
    small.samples = 1;
    EXPECT_EQ(next_pass(small).kind, Pass::Kind::wait);
    small.drafted = false;
    EXPECT_EQ(next_pass(small).kind, Pass::Kind::full);
}

TEST(Schedule, NoPreviewsWhereTheFilmIsAsQuick) {
    ScheduleState state = state_1280x720();
    state.width = state.height = 100;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
    EXPECT_EQ(next_pass(state).samples, 1);
}

TEST(Schedule, HeadlessHasNoPreviewsAndPublishesAtTheEnd) {
    ScheduleState state = state_1280x720();
    state.interactive = false;
    state.max_samples = 4;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
    state.samples = 3;
    state.unpublished = true;
    EXPECT_FALSE(publish_now(state));
    state.samples = 4;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::finished);
    EXPECT_TRUE(publish_now(state));
}

TEST(Schedule, PassesNeverGoBeyondTheSampleLimit) {
    ScheduleState state = state_1280x720();
    state.width = state.height = 16;
    state.max_samples = 37;
    state.render_seconds = 10;
    int passes = 0;
    for (; next_pass(state).kind == Pass::Kind::full; ++passes) {
        const int samples = next_pass(state).samples;
        ASSERT_GT(samples, state.samples);
        ASSERT_LE(samples, 37);
        state.samples = samples;
    }
    EXPECT_EQ(state.samples, 37);
    EXPECT_LT(passes, 10);
    state.max_samples = 40;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
}

TEST(Schedule, TimeLimitCutsAllPassesButTheFirst) {
    ScheduleState state = state_1280x720();
    state.interactive = false;
    state.max_seconds = 2;
    EXPECT_EQ(next_pass(state).stop_at, 0);
    state.samples = 1;
    state.render_seconds = 1.5;
    EXPECT_EQ(next_pass(state).stop_at, 2);
    state.render_seconds = 2;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::finished);
    state.samples = 0;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
}

TEST(Schedule, PausedShowsOneSampleOfAnEditAndRests) {
    ScheduleState state = state_1280x720();
    state.paused = true;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::coarse);
    state.preview_done = true;
    state.quiet_seconds = 1;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
    EXPECT_EQ(next_pass(state).samples, 1);
    state.samples = 1;
    state.unpublished = true;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::paused);
    EXPECT_TRUE(publish_now(state));
}

TEST(Schedule, PassesAreBriefWhileEditsScaleTheFilm) {
    ScheduleState state = state_1280x720();
    state.samples = 5;
    state.render_seconds = 3;
    state.since_relit = 0.02;
    const Pass pass = next_pass(state);
    EXPECT_EQ(pass.kind, Pass::Kind::brief);
    EXPECT_EQ(pass.samples, 6);
    EXPECT_NEAR(pass.stop_at, 3.012, 0.005);
    state.max_seconds = 3.001;
    EXPECT_EQ(next_pass(state).stop_at, 3.001);
    state.max_seconds = 0;
    state.since_relit = 0.1;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
    state.since_relit = 0.02;
    state.paused = true;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::paused);
    state.paused = state.interactive = false;
    EXPECT_EQ(next_pass(state).kind, Pass::Kind::full);
}

TEST(Schedule, PublishesAtOnceThenLessOften) {
    ScheduleState state = state_1280x720();
    EXPECT_FALSE(publish_now(state));
    state.unpublished = true;
    EXPECT_FALSE(publish_now(state)) << "the film has holes";
    state.samples = 1;
    state.since_publication = 0.001;
    EXPECT_TRUE(publish_now(state)) << "first complete film";
    state.film_shown = true;
    EXPECT_FALSE(publish_now(state));
    state.since_publication = 1.0 / 59;
    EXPECT_TRUE(publish_now(state));
    state.publish_seconds = 0.01;
    EXPECT_FALSE(publish_now(state)) << "a tenth of the time at most";
    state.since_publication = 0.11;
    EXPECT_TRUE(publish_now(state));
    state.render_seconds = 60;
    EXPECT_FALSE(publish_now(state)) << "the image hardly changes any more";
    state.since_publication = 0.51;
    EXPECT_TRUE(publish_now(state));
}

}  // namespace
}  // namespace rayuela
