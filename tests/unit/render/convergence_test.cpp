#include "core/render/convergence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayuela {
namespace {

/// Error c / N^p, 0.5 s to build and 0.25 s a sample.
ConvergenceRun power_law(double c, double p) {
    ConvergenceRun run{.build_cpu_seconds = 0.5, .build_wall_seconds = 0.5};
    for (int spp = 1; spp <= 64; spp *= 2) {
        run.checkpoints.push_back({.spp = spp, .cpu_seconds = 0.25 * spp, .error = {.rel_mse = c / std::pow(spp, p)}});
    }
    return run;
}

Curve curve_of(const std::vector<ConvergenceRun>& runs, double load_seconds = 0) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < runs.size(); ++i) all.push_back(i);
    return mean_curve(runs, all, load_seconds);
}

TEST(Convergence, MeanCurveIncludesLoadingAndBuilding) {
    const Curve curve = curve_of({power_law(1, 1), power_law(3, 1)}, 2);
    ASSERT_EQ(curve.size(), 7u);
    EXPECT_EQ(curve[3].spp, 8);
    EXPECT_DOUBLE_EQ(curve[3].seconds, 2 + 0.5 + 0.25 * 8);
    EXPECT_DOUBLE_EQ(curve[3].error, 2.0 / 8);
}

TEST(Convergence, ReadingsOfAPowerLaw) {
    // Error 1 / N^1.5: 0.01 is reached after 100^(2/3) samples.
    const Curve curve = curve_of({power_law(1, 1.5)});
    const double spp = std::pow(100, 2.0 / 3);
    EXPECT_NEAR(samples_to(curve, 0.01).value, spp, 1e-9);
    EXPECT_EQ(samples_to(curve, 0.01).kind, Reading::Kind::inside);
    EXPECT_NEAR(seconds_to(curve, 0.01).value, 0.5 + 0.25 * spp, 1e-9);
    EXPECT_NEAR(error_at(curve, 0.5 + 0.25 * spp).value, 0.01, 1e-12);
    EXPECT_NEAR(convergence_slope(curve), -1.5, 1e-12);
}

TEST(Convergence, BeyondTheLastPointErrorFallsAsOneOverSamples) {
    const Curve curve = curve_of({power_law(1, 1.5)});  // 1 / 512 at 64 samples
    const Reading spp = samples_to(curve, 1.0 / 1024);
    EXPECT_NEAR(spp.value, 128, 1e-9);
    EXPECT_EQ(spp.kind, Reading::Kind::beyond);
    EXPECT_NEAR(seconds_to(curve, 1.0 / 1024).value, 0.5 + 0.25 * 128, 1e-9);
    EXPECT_NEAR(error_at(curve, 0.5 + 0.25 * 128).value, 1.0 / 1024, 1e-12);
    EXPECT_EQ(error_at(curve, 0.5 + 0.25 * 128).kind, Reading::Kind::beyond);
}

TEST(Convergence, BeforeTheFirstPointThereIsABound) {
    const Curve curve = curve_of({power_law(1, 1)});
    EXPECT_EQ(samples_to(curve, 2).value, 1);
    EXPECT_EQ(samples_to(curve, 2).kind, Reading::Kind::before);
    EXPECT_EQ(error_at(curve, 0.6).kind, Reading::Kind::before);
    EXPECT_EQ(error_at(curve, 0.75).value, 1);
}

TEST(Convergence, AnErrorThatStopsFallingHasSlopeZero) {
    ConvergenceRun run = power_law(0, 1);
    for (Checkpoint& checkpoint : run.checkpoints) checkpoint.error.rel_mse = 0.3;
    EXPECT_NEAR(convergence_slope(curve_of({run})), 0, 1e-12);
}

TEST(Convergence, ImagesBetterThanTheReferenceAreLeftOut) {
    ConvergenceRun run = power_law(1, 1);
    run.checkpoints.back().error.rel_mse = -1e-9;
    EXPECT_EQ(curve_of({run}).size(), 6u);
    EXPECT_EQ(curve_of({run}).back().spp, 32);
}

TEST(Convergence, IntervalsSpanTheSeeds) {
    const std::vector<ConvergenceRun> runs = {power_law(1, 1), power_law(2, 1), power_law(3, 1)};
    const Measured error = measure(runs, 0, [](const Curve& curve) { return curve.back().error; });
    EXPECT_DOUBLE_EQ(error.value, 2.0 / 64);
    EXPECT_GE(error.interval.low, 1.0 / 64);
    EXPECT_LE(error.interval.high, 3.0 / 64);
    EXPECT_LT(error.interval.low, error.interval.high);
    const Measured slope = measure(runs, 0, convergence_slope);
    EXPECT_NEAR(slope.interval.low, -1, 1e-12);
    EXPECT_NEAR(slope.interval.high, -1, 1e-12);
}

}  // namespace
}  // namespace rayuela
