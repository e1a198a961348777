#pragma once

#include "core/accel/parallel.h"
#include "tests/support/accel_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Randomised tests in numbers that the test suite has no time for. Each holds the code to an oracle or a closed form and
/// says how far it was off at worst.
namespace rayuela::stress {

/// What a test has found so far.
struct Outcome {
    std::uint64_t cases = 0;
    std::uint64_t failures = 0;
    double worst = 0;     ///< The largest figure measured; infinite where one was NaN.
    std::string failure;  ///< The first case that failed, to be found again.
    std::string note;     ///< What else a person may want to know.

    /// A case has this figure: smaller is better, the test knows the limit.
    void measure(double figure) {
        if (!(figure <= worst)) worst = std::isnan(figure) ? INFINITY : figure;
    }
    /// `describe` gives the text for a person where the case failed.
    template <typename Describe>
    void expect(bool holds, const Describe& describe) {
        if (holds) return;
        if (failures++ == 0) failure = describe();
    }
    void add(const Outcome& later);
};

struct StressTest {
    int number;  ///< In the catalogue of robustness; several tests may share one.
    std::string_view name;
    std::string_view figure;  ///< What `Outcome::worst` is.
    double required;          ///< Largest figure that passes, given that no case fails.
    /// Runs about `scale` times the full number of cases.
    Outcome (*run)(double scale);

    bool passed(const Outcome& outcome) const {
        return outcome.cases > 0 && outcome.failures == 0 && outcome.worst <= required;
    }
};

/// All of them, by number.
std::vector<StressTest> stress_tests();

/// `full` times `scale`, at least `least`.
inline std::uint64_t scaled(double full, double scale, std::uint64_t least = 1) {
    return std::max(least, static_cast<std::uint64_t>(std::llround(full * scale)));
}

/// body(random, first, n, outcome) on batches of up to `batch` of the `count` cases, in parallel. Random numbers depend on the seed
/// and the batch alone, so that any number of threads finds the same.
template <typename Body>
Outcome for_batches(std::uint64_t count, std::uint64_t seed, std::uint64_t batch, const Body& body) {
    const std::uint64_t batches = (count + batch - 1) / batch;
    const auto outcome_of = [&](std::size_t i, std::size_t) {
        test::Random random((seed << 40) + i);
        Outcome outcome{.cases = std::min(batch, count - i * batch)};
        body(random, i * batch, outcome.cases, outcome);
        return outcome;
    };
    const auto join = [](Outcome a, const Outcome& b) {
        a.add(b);
        return a;
    };
    return parallel_sum(0, batches, 1, outcome_of, join);
}

/// body(random, outcome) for each case.
template <typename Body>
Outcome for_cases(std::uint64_t count, std::uint64_t seed, const Body& body) {
    return for_batches(count, seed, 4096, [&](test::Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
        for (std::uint64_t i = 0; i < n; ++i) body(random, outcome);
    });
}

std::string describe(const Vec3& v);
std::string describe(const Ray& ray);

// The lists of the files.
std::vector<StressTest> sphere_tests();
std::vector<StressTest> flat_shape_tests();
std::vector<StressTest> watertight_tests();
std::vector<StressTest> kd_build_tests();
std::vector<StressTest> kd_invariant_tests();
std::vector<StressTest> padding_tests();
std::vector<StressTest> traversal_tests();
std::vector<StressTest> offset_tests();
std::vector<StressTest> light_leak_tests();
std::vector<StressTest> sampling_tests();
std::vector<StressTest> bsdf_tests();
std::vector<StressTest> radiometry_tests();
std::vector<StressTest> film_tests();
std::vector<StressTest> adaptive_tests();
std::vector<StressTest> camera_scale_tests();
std::vector<StressTest> file_tests();
std::vector<StressTest> determinism_tests();

}  // namespace rayuela::stress
