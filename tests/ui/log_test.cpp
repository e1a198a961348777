#include "ui/log.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

TEST(Log, CountsWhatRepeats) {
    Log log;
    for (int i = 0; i < 3; ++i) log.add(LogLevel::error, "radius: must be > 0");
    log.add(LogLevel::info, "radius: must be > 0");
    ASSERT_EQ(log.entries().size(), 2u);
    EXPECT_EQ(log.entries()[0].count, 3);
    EXPECT_EQ(log.entries()[1].count, 1);
}

TEST(Log, HasOneEntryForEachProblem) {
    Log log;
    log.add(LogLevel::warning, Problems{{"a.obj", "line 3", "no face"}, {"a.obj", "", "no normals"}});
    ASSERT_EQ(log.entries().size(), 2u);
    EXPECT_EQ(log.entries()[0].text, "a.obj: line 3: no face");
    EXPECT_EQ(log.entries()[1].text, "a.obj: no normals");
}

TEST(Log, ForgetsTheOldest) {
    Log log;
    for (std::size_t i = 0; i < kMaxLogEntries + 2; ++i) log.add(LogLevel::info, std::to_string(i));
    EXPECT_EQ(log.entries().size(), kMaxLogEntries);
    EXPECT_EQ(log.entries().front().text, "2");
}

}  // namespace
}  // namespace rayuela
