#include "ui/convergence.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

RenderStatistics at(int spp, std::uint64_t restarts = 0) {
    RenderStatistics statistics;
    statistics.spp = spp;
    statistics.render_seconds = spp * 0.1;
    statistics.estimated_error = 1.0 / spp;
    statistics.restarts = restarts;
    return statistics;
}

TEST(Convergence, KeepsFewPointsOfManySamples) {
    ConvergenceHistory history;
    for (int spp = 1; spp <= 100000; ++spp) history.add(at(spp));
    EXPECT_LT(history.samples.size(), 700u);
    EXPECT_GT(history.samples.size(), 100u);
    EXPECT_TRUE(std::ranges::is_sorted(history.samples));
    EXPECT_EQ(history.samples.front(), 1);
    EXPECT_GT(history.samples.back(), 95000);
}

TEST(Convergence, StartsAnewWithTheAccumulation) {
    ConvergenceHistory history;
    history.add(at(4));
    history.add(at(8));
    history.add(at(2, 1));
    EXPECT_THAT(history.samples, testing::ElementsAre(2));
    EXPECT_THAT(history.error, testing::ElementsAre(0.5));
}

TEST(Convergence, LeavesOutAnUnknownError) {
    ConvergenceHistory history;
    RenderStatistics unknown = at(1);
    unknown.estimated_error = 0;
    history.add(unknown);
    EXPECT_TRUE(history.empty());
}

}  // namespace
}  // namespace rayuela
