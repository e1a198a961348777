#include "tests/stress/paths.h"

#include <fmt/format.h>

#include <random>

namespace rayuela::stress {
namespace {

using namespace rayuela::testing;

/// One pixel's mean of many samples against the sum in long double.
Outcome long_sums(double scale) {
    const std::uint64_t count = scaled(5e7, scale, 1000);
    Outcome outcome;
    for (const bool firefly : {false, true}) {
        Film film(1, 1);
        long double sum = 0;
        test::Random random(45);
        for (std::uint64_t i = 0; i < count; ++i) {
            float x = -std::log(1 - random.uniform(0, 0.999999f));
            if (firefly) x = i == count / 3 ? 1e6f : 0.01f;
            film.add(0, static_cast<std::uint32_t>(i), Color(x));
            sum += x;
        }
        const long double mean = sum / static_cast<long double>(count);
        for (int channel = 0; channel < 3; ++channel)
            outcome.measure(static_cast<double>(std::fabs(film.mean(0)[channel] - mean) / mean));
        outcome.cases += count;
    }
    return outcome;
}

std::vector<Vec3d> in_passes(const Scene& scene, int samples, int samples_a_pass) {
    Passes passes(scene);
    // What an edit throws away leaves no trace.
    passes.render_to(1);
    passes.film().restart();
    for (int n = samples_a_pass; passes.film().samples() < samples; n += samples_a_pass)
        passes.render_to(std::min(n, samples));
    return means(passes.film().film());
}

Outcome passes(double scale) {
    Outcome outcome;
    const int samples = static_cast<int>(scaled(512, scale, 6));
    const Scene scene = mixed_scene(75, 70);
    const auto expected = in_passes(scene, samples, samples);
    for (const int samples_a_pass : {1, 2, 7}) {
        const auto actual = in_passes(scene, samples, samples_a_pass);
        for (std::size_t i = 0; i < actual.size(); ++i)
            outcome.expect(actual[i] == expected[i],
                           [&] { return fmt::format("pixel {} in passes of {}", i, samples_a_pass); });
        outcome.cases += actual.size();
    }
    return outcome;
}

/// Bad samples one in a million: left out, counted by cause, and without a trace in what is kept.
Outcome bad_samples(double scale) {
    constexpr int kSide = 64;
    const std::uint64_t count = scaled(1e8, scale);
    const float bad_values[] = {NAN, INFINITY, -1e-3f};
    Film clean(kSide, kSide), dirty(kSide, kSide);
    std::array<std::uint64_t, kRejectionCount> injected{};
    std::mt19937_64 random(47);
    // Fewer samples, more bad ones, so that there always are some.
    const std::uint64_t period = std::min<std::uint64_t>(1'000'000, count / 50 + 1);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t bits = random();
        const std::size_t pixel = bits % (kSide * kSide);
        const auto sample = static_cast<std::uint32_t>(i / (kSide * kSide));
        const Color radiance = Color(static_cast<float>(bits >> 40) * 0x1p-24f, 0.5f, 2);
        if (bits / 4096 % period == 0) {
            const std::size_t cause = (bits >> 20) % kRejectionCount;
            Color bad = radiance;
            bad[static_cast<int>(bits >> 50) % 3] = bad_values[cause];
            dirty.add(pixel, sample, bad);
            ++injected[cause];
        }
        clean.add(pixel, sample, radiance);
        dirty.add(pixel, sample, radiance);
    }
    Outcome outcome;
    outcome.cases = count;
    for (std::size_t pixel = 0; pixel < kSide * kSide; ++pixel) {
        outcome.expect(clean.mean(pixel) == dirty.mean(pixel) && clean.count(pixel) == dirty.count(pixel),
                       [&] { return fmt::format("pixel {}", pixel); });
    }
    for (std::size_t cause = 0; cause < kRejectionCount; ++cause) {
        outcome.expect(dirty.rejected()[cause] == injected[cause] && injected[cause] > 0, [&] {
            return fmt::format("cause {}: {} of {} counted", cause, dirty.rejected()[cause], injected[cause]);
        });
    }
    return outcome;
}

}  // namespace

std::vector<StressTest> film_tests() {
    return {{45, "film: sums of 5e7 samples, with a firefly", "relative error", 1e-6, long_sums},
            {46, "film: passes of 1 are one pass of N, edits clear", "-", 0, passes},
            {47, "film: bad samples are left out and counted", "-", 0, bad_samples}};
}

}  // namespace rayuela::stress
