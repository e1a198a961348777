#include "core/math/statistics.h"

#include "core/math/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayuela {
namespace {

double mean_of(const std::vector<double>& values, std::span<const std::size_t> chosen) {
    double sum = 0;
    for (const std::size_t i : chosen) sum += values[i];
    return sum / static_cast<double>(chosen.size());
}

TEST(Statistics, SlopeOfALineIsExact) {
    const double x[] = {1, 2, 4, 7}, y[] = {5 - 3 * 1, 5 - 3 * 2, 5 - 3 * 4, 5 - 3 * 7};
    EXPECT_DOUBLE_EQ(slope(x, y), -3);
    const double symmetric[] = {1, -1, -1, 1};
    EXPECT_NEAR(slope(std::vector<double>{-3, -1, 1, 3}, symmetric), 0, 1e-15);
    EXPECT_TRUE(std::isnan(slope(std::vector<double>{2, 2}, std::vector<double>{1, 3})));
}

TEST(Statistics, BootstrapOfOneOrOfEqualsIsAPoint) {
    for (const std::vector<double>& values : {std::vector<double>{7}, std::vector<double>{7, 7, 7}}) {
        const Measured m = bootstrap(values.size(), [&](auto chosen) { return mean_of(values, chosen); });
        EXPECT_EQ(m.value, 7);
        EXPECT_EQ(m.interval.low, 7);
        EXPECT_EQ(m.interval.high, 7);
    }
}

TEST(Statistics, IntervalOfAMeanIsAsWideAsItsStandardError) {
    // Of n uniform numbers: 2 x 1.96 standard deviations of the mean, sqrt(1/12 / n).
    const std::size_t n = 400;
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(to_unit_float(static_cast<std::uint32_t>(mix_bits(i + 1))));
    const Measured m = bootstrap(n, [&](auto chosen) { return mean_of(values, chosen); });
    const double width = m.interval.high - m.interval.low;
    EXPECT_NEAR(width, 2 * 1.96 / std::sqrt(12.0 * n), 0.1 * width);
    EXPECT_LT(m.interval.low, m.value);
    EXPECT_GT(m.interval.high, m.value);
}

TEST(Statistics, IntervalsContainTheTruthAboutAsOftenAsTheySay) {
    int contained = 0;
    for (std::size_t trial = 0; trial < 200; ++trial) {
        std::vector<double> values;
        for (std::size_t i = 0; i < 16; ++i) {
            values.push_back(to_unit_float(static_cast<std::uint32_t>(mix_bits(trial * 16 + i + 1))));
        }
        const Interval interval = bootstrap(16, [&](auto chosen) { return mean_of(values, chosen); }).interval;
        contained += interval.low <= 0.5 && interval.high >= 0.5;
    }
    EXPECT_GE(contained,
              175);  // 95% of 200, less the few percent by which percentiles of 16 fall short and three sigma.
    EXPECT_LT(contained, 200);
}

TEST(Statistics, ResamplesWithoutAStatisticAreLeftOut) {
    const Measured m = bootstrap(3, [](auto chosen) { return chosen[0] == 0 ? std::nan("") : double(chosen[0]); });
    EXPECT_TRUE(std::isnan(m.value));
    EXPECT_EQ(m.interval.low, 1);
    EXPECT_EQ(m.interval.high, 2);
}

}  // namespace
}  // namespace rayuela
