#include "ui/number_text.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

TEST(NumberText, Durations) {
    EXPECT_EQ(duration_text(0), "0.0 s");
    EXPECT_EQ(duration_text(0.0032), "3.2 ms");
    EXPECT_EQ(duration_text(12.34), "12.3 s");
    EXPECT_EQ(duration_text(200), "3 min 20 s");
    EXPECT_EQ(duration_text(7500), "2 h 5 min");
}

TEST(NumberText, ThreeDigitsAndAPrefix) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(980), "980");
    EXPECT_EQ(count_text(999.7), "1.00k");
    EXPECT_EQ(count_text(12345), "12.3k");
    EXPECT_EQ(count_text(99960), "100k");
    EXPECT_EQ(count_text(4.56e6), "4.56M");
    EXPECT_EQ(count_text(9.9999e6), "10.0M");
    EXPECT_EQ(count_text(2e16), "20000T");
    EXPECT_EQ(quantity_text(4.56e6, "samples/s"), "4.56 Msamples/s");
    EXPECT_EQ(quantity_text(12, "B"), "12 B");
}

TEST(NumberText, GroupsOfThreeDigits) {
    EXPECT_EQ(grouped_text(0), "0");
    EXPECT_EQ(grouped_text(123), "123");
    EXPECT_EQ(grouped_text(1234), "1 234");
    EXPECT_EQ(grouped_text(1234567), "1 234 567");
}

TEST(NumberText, AmountsOfBytesAreRoundedOthersAreNot) {
    EXPECT_EQ(amount_text(123456, "bytes"), "123 kB");
    EXPECT_EQ(amount_text(123456, "objects"), "123 456 objects");
    EXPECT_EQ(amount_text(1, "objects"), "1 object");
    EXPECT_EQ(amount_text(0, "objects"), "0 objects");
}

}  // namespace
}  // namespace rayuela
