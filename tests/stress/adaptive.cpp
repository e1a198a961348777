#include "core/render/adaptive_block.h"
#include "tests/stress/paths.h"

#include <fmt/format.h>

#include <random>

namespace rayuela::stress {
namespace {

using namespace rayuela::testing;

/// Mean and variance of numbers that come in any order.
struct Moments {
    double mean = 0, variance_of_mean = 0;

    explicit Moments(const std::vector<double>& values) {
        const auto n = static_cast<double>(values.size());
        for (const double x : values) mean += x / n;
        for (const double x : values) variance_of_mean += (x - mean) * (x - mean) / (n * (n - 1));
    }
};

/// Adaptive against true or fixed means. Figure: |z|. Where the numbers suffice, a bias of 0.1% is a failure too.
void compare(Outcome& outcome, const char* name, const Moments& adaptive, double expected, double variance,
             double samples) {
    constexpr double kLargestBias = 1e-3;
    const double deviation = std::sqrt(adaptive.variance_of_mean + variance);
    const double bias = adaptive.mean / expected - 1, noise = deviation / expected;
    outcome.measure(std::fabs(adaptive.mean - expected) / deviation);
    outcome.expect(std::fabs(bias) <= std::max(kLargestBias, 4 * noise),
                   [&] { return fmt::format("{}: bias {:.3f} %", name, 100 * bias); });
    outcome.note += fmt::format("{}{}: bias {:+.3f} +- {:.3f} % at {:.0f} samples a pixel",
                                outcome.note.empty() ? "" : "; ", name, 100 * bias, 100 * noise, samples);
}

constexpr std::size_t kBlocks = 16, kBlockPixels = 256;
constexpr int kMostSamples = 1024;

/// What an adaptive image of independent samples shows on average, and what it took.
struct AdaptiveMean {
    double mean = 0, samples = 0;
};

/// draw(block, random) gives a sample.
template <typename Draw>
AdaptiveMean adaptive_mean(double target_error, std::mt19937& random, const Draw& draw) {
    Film film(kBlockPixels, kBlocks);
    film.set_equal_halves(true);
    std::vector<AdaptiveBlock> blocks(kBlocks, AdaptiveBlock(kBlockPixels));
    std::vector<const AdaptiveBlock*> all;
    for (AdaptiveBlock& block : blocks) {
        block.start_measuring(0);
        all.push_back(&block);
    }
    AdaptiveMean result;
    for (int begin = 0, end = next_decision(0); begin < kMostSamples; begin = end, end = next_decision(begin)) {
        for (std::size_t b = 0; b < kBlocks; ++b) {
            if (blocks[b].stopped()) continue;
            for (auto sample = static_cast<std::uint32_t>(begin); sample < static_cast<std::uint32_t>(end); ++sample) {
                for (std::size_t pixel = 0; pixel < kBlockPixels; ++pixel) {
                    const float y = draw(b, random);
                    blocks[b].measure(pixel, sample, y);
                    if (blocks[b].shows(sample)) film.add(b * kBlockPixels + pixel, sample, Color(y));
                }
            }
            blocks[b].set_shown(end);
            blocks[b].update_noise(end);
            result.samples += (end - begin) / static_cast<double>(kBlocks);
        }
        const auto mean = mean_burden(all);
        for (AdaptiveBlock& block : blocks) {
            if (!block.stopped()) block.stop_where_enough(end, mean, target_error);
        }
    }
    for (std::size_t pixel = 0; pixel < kBlocks * kBlockPixels; ++pixel)
        result.mean += film.mean(pixel).x / static_cast<double>(kBlocks * kBlockPixels);
    return result;
}

template <typename Draw>
void compare_with_truth(Outcome& outcome, const char* name, double target_error, std::uint64_t images,
                        const Draw& draw) {
    std::vector<double> means(images), samples(images);
    outcome.add(for_batches(images, 48, 1, [&](test::Random&, std::uint64_t first, std::uint64_t, Outcome&) {
        std::mt19937 random(static_cast<unsigned>(first));
        const AdaptiveMean image = adaptive_mean(target_error, random, draw);
        means[first] = image.mean;
        samples[first] = image.samples;
    }));
    const double taken = Moments(samples).mean;
    outcome.expect(taken > 1.2 * AdaptiveBlock::kMinSamples && taken < 0.9 * kMostSamples,
                   [&] { return fmt::format("{}: {} samples a pixel say nothing", name, taken); });
    compare(outcome, name, Moments(means), 1, 0, taken);
}

/// Independent samples of known distributions, all of mean 1, in blocks of different noise.
Outcome known_distributions(double scale) {
    Outcome outcome;
    compare_with_truth(outcome, "lognormal", 0.1, scaled(2500, scale, 30), [](std::size_t block, auto& random) {
        const float sigma = block % 2 == 0 ? 0.5f : 1.5f;
        return std::exp(sigma * std::normal_distribution<float>()(random) - 0.5f * sigma * sigma);
    });
    compare_with_truth(outcome, "rare", 1.3, scaled(12000, scale, 100), [](std::size_t block, auto& random) {
        // In half of the blocks 0.7 of the light comes with a thousandth of the samples.
        const bool hit = std::uniform_real_distribution<float>()(random) < 1e-3f;
        return block % 2 == 0 ? 1.0f : 0.3f + (hit ? 700.0f : 0.0f);
    });
    return outcome;
}

/// A caustic of a small lamp that camera paths find by chance.
Scene rare_caustic() {
    Scene scene = empty_scene(48, 32);
    scene.camera.position = Vec3(0, 2, 6);
    scene.camera.target = Vec3(0, 0.7f, 0);
    scene.environment = ConstantEnvironment{Color(0.1f)};
    add_object(scene, Plane{}, add_material(scene, Diffuse{}));
    add_object(scene, Sphere{Vec3(0, 1, 0), 0.7f}, add_material(scene, Dielectric{}));
    add_object(scene, Sphere{Vec3(1, 4, 1), 0.15f}, add_material(scene, Emitter{.radiance = {Color(100), nullptr}}));
    return scene;
}

/// Mean over the image, and samples a pixel.
AdaptiveMean mean_of_render(Scene scene, std::uint32_t seed, const SamplingOptions& sampling, int samples) {
    scene.render.seed = seed;
    const auto render_scene = make_render_scene(scene);
    const PathTracer tracer(*render_scene, scene.film.width, scene.film.height, {.light_tracing = false});
    Accumulation film(scene.film.width, scene.film.height);
    film.set_options(sampling);
    const std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> done{0};
    PassControl control{.cancelled = cancelled, .paths_done = done};
    film.add_samples(tracer, samples, control);
    return {estimate(film.film()).mean, film.spread().mean};
}

Outcome rendered_caustic(double scale) {
    const Scene scene = rare_caustic();
    const std::uint64_t images = scaled(4000, scale, 12);
    std::vector<double> fixed(images), adaptive(images), samples(images);
    Outcome outcome = for_batches(images, 48, 1, [&](test::Random&, std::uint64_t i, std::uint64_t, Outcome&) {
        const auto seed = static_cast<std::uint32_t>(2 * i);
        fixed[i] = mean_of_render(scene, seed, {}, 128).mean;
        const AdaptiveMean image = mean_of_render(scene, seed + 1, {.target_error = 0.12}, kMostSamples);
        adaptive[i] = image.mean;
        samples[i] = image.samples;
    });
    const Moments expected(fixed);
    compare(outcome, "caustic", Moments(adaptive), expected.mean, expected.variance_of_mean, Moments(samples).mean);
    return outcome;
}

/// What a clamped image lacks is what it says that it lacks; without a clamp nothing is lacking.
Outcome clamp(double scale) {
    Outcome outcome;
    const int samples = static_cast<int>(scaled(1024, scale, 8));
    for (const Scene& scene : {mixed_scene(96, 64), rare_caustic()}) {
        Passes plain(scene);
        plain.render_to(samples);
        const double whole = estimate(plain.film().film()).mean;
        outcome.expect(SamplingOptions{}.clamp == 0 && plain.film().clamp_loss().removed == 0,
                       [] { return std::string("on by default"); });
        for (const float limit : {0.05f, 1.0f, 1e30f}) {
            Passes clamped(scene);
            clamped.film().set_options({.clamp = limit});
            clamped.render_to(samples);
            // Light paths are not clamped.
            const double left = estimate(clamped.film().film()).mean;
            const ClampLoss loss = clamped.film().clamp_loss();
            outcome.measure(std::fabs(left + loss.removed - whole) / whole);
            outcome.measure(std::fabs(loss.share - loss.removed / whole));
            outcome.expect(limit == 1 || (loss.removed > 0) == (limit < 1),
                           [&] { return fmt::format("limit {:g}", limit); });
            outcome.cases += static_cast<std::uint64_t>(samples * scene.film.width * scene.film.height);
        }
    }
    return outcome;
}

}  // namespace

std::vector<StressTest> adaptive_tests() {
    return {{48, "adaptive: no bias on known distributions", "|z|", 4, known_distributions},
            {48, "adaptive: no bias on a rare caustic", "|z|", 4, rendered_caustic},
            {49, "clamp: off by default, else says what it takes", "relative difference", 1e-6, clamp}};
}

}  // namespace rayuela::stress
