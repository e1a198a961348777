#include "core/render/adaptive_block.h"

#include <gtest/gtest.h>

#include <random>

namespace rayuela {
namespace {

constexpr std::size_t kPixels = 256;

/// Gives every pixel of the block the samples from `begin` to `end`; value(half, random).
template <typename Value>
void measure(AdaptiveBlock& block, int begin, int end, const Value& value) {
    std::mt19937 random(7);
    for (int sample = begin; sample < end; ++sample) {
        for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
            const auto number = static_cast<std::uint32_t>(sample);
            block.measure(pixel, number, value(sample_half(number), random));
        }
    }
    block.set_shown(end);
    block.update_noise(end);
}

AdaptiveBlock new_block() {
    AdaptiveBlock block(kPixels);
    block.start_measuring(0);
    return block;
}

TEST(AdaptiveBlock, SamplesReachTheTargetWithTheLeastWork) {
    // Errors of blocks of deviation s and n samples are s^2 / n: their mean is to be the target's square.
    struct Case {
        double deviation, cost;
    };
    const Case cases[] = {{0.1, 1}, {0.5, 9}, {1, 4}, {3, 16}};
    const double target = 0.03;
    double burden = 0, error = 0, work = 0, uniform_error = 0, uniform_work = 0;
    for (const Case& c : cases) burden += c.deviation * std::sqrt(c.cost) / 4;
    for (const Case& c : cases) {
        const double samples = samples_wanted(c.deviation, c.cost, burden, target);
        error += c.deviation * c.deviation / samples / 4;
        work += c.cost * samples;
        uniform_error += c.deviation * c.deviation / 4;
        uniform_work += c.cost;
    }
    EXPECT_NEAR(error, target * target, 1e-12);
    EXPECT_LT(work, uniform_work * uniform_error / (target * target));
    const double dearer = samples_wanted(1, 4, burden, target), cheaper = samples_wanted(1, 1, burden, target);
    EXPECT_NEAR(cheaper / dearer, 2, 1e-12);
}

TEST(AdaptiveBlock, CostIsThatOfTheHalf) {
    AdaptiveBlock block(kPixels);
    block.start_measuring(0);
    EXPECT_EQ(block.cost(0), 1);
    for (int sample = 0; sample < 64; sample = end_of_half(sample)) {
        const int end = end_of_half(sample), half = static_cast<int>(sample_half(static_cast<std::uint32_t>(sample)));
        for (int i = std::max(16, sample); i < end; ++i)
            EXPECT_EQ(static_cast<int>(sample_half(static_cast<std::uint32_t>(i))), half);
        for (int i = sample; i < end; ++i) block.measure(0, static_cast<std::uint32_t>(i), 1);
        block.add_cost(static_cast<std::uint32_t>(sample), static_cast<std::uint64_t>((end - sample) * (half + 3)));
    }
    EXPECT_EQ(block.cost(0), 3);
    EXPECT_EQ(block.cost(1), 4);
}

TEST(AdaptiveBlock, DecidesAtPowersOfTwo) {
    EXPECT_EQ(next_decision(0), 32);
    EXPECT_EQ(next_decision(31), 32);
    EXPECT_EQ(next_decision(32), 64);
    EXPECT_EQ(next_decision(100), 128);
}

TEST(AdaptiveBlock, MeasuresTheDeviationOfEachHalf) {
    AdaptiveBlock block = new_block();
    EXPECT_FALSE(block.knows_noise());
    // Uniform in [0, 2]: deviation 1 / sqrt(3), mean 1. Constant 5: none.
    const auto value = [](std::uint32_t half, auto& random) {
        return half == 0 ? std::uniform_real_distribution<float>(0, 2)(random) : 5.0f;
    };
    measure(block, 0, 32, value);
    measure(block, 32, 64, value);
    measure(block, 64, 128, value);
    EXPECT_TRUE(block.knows_noise());
    EXPECT_NEAR(block.deviation(0), std::sqrt(1.0 / 3 / 1.01), 0.03);
    EXPECT_EQ(block.deviation(1), 0);
}

TEST(AdaptiveBlock, KnowsNothingFromPartOfAnOctave) {
    AdaptiveBlock block(kPixels);
    block.start_measuring(20);
    const auto value = [](std::uint32_t, auto& random) { return std::uniform_real_distribution<float>(0, 2)(random); };
    measure(block, 20, 32, value);
    EXPECT_FALSE(block.knows_noise());
    block.stop_where_enough(32, {1, 1}, 1);
    EXPECT_FALSE(block.stopped(0));
    measure(block, 32, 64, value);
    EXPECT_TRUE(block.knows_noise());
}

TEST(AdaptiveBlock, HalvesAreStoppedByEachOther) {
    AdaptiveBlock block = new_block();
    // The first half is calm, so the second is stopped, and goes on unseen.
    const auto value = [](std::uint32_t half, auto& random) {
        return half == 1 ? std::uniform_real_distribution<float>(0, 2)(random) : 5.0f;
    };
    measure(block, 0, 32, value);
    block.stop_where_enough(32, {0.5, 0.5}, 0.05);
    EXPECT_TRUE(block.stopped(1));
    EXPECT_FALSE(block.stopped(0));
    EXPECT_FALSE(block.stopped());
    for (std::uint32_t sample = 32; sample < 64; ++sample) EXPECT_EQ(block.shows(sample), sample_half(sample) == 0);
    measure(block, 32, 64, value);
    EXPECT_EQ(block.shown(0), 32);
    EXPECT_EQ(block.shown(1), 16);

    // Going on, the second half gets what it lacks, and the first nothing twice.
    EXPECT_EQ(block.resume(64), 32);
    for (std::uint32_t sample = 32; sample < 64; ++sample) EXPECT_EQ(block.shows(sample), sample_half(sample) == 1);
    block.set_shown(64);
    EXPECT_EQ(block.shown(0) + block.shown(1), 64);
    EXPECT_TRUE(block.shows(64));
}

TEST(AdaptiveBlock, CountsTheSamplesOfEachHalf) {
    AdaptiveBlock block(kPixels);
    int counts[2] = {};
    for (int samples = 0; samples < 300; ++samples) {
        block.set_shown(samples);
        EXPECT_EQ(block.shown(0), counts[0]) << samples;
        EXPECT_EQ(block.shown(1), counts[1]) << samples;
        ++counts[sample_half(static_cast<std::uint32_t>(samples))];
    }
}

}  // namespace
}  // namespace rayuela
