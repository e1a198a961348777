#include "core/render/clamp.h"
#include "core/render/skips.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

using namespace rayuela::testing;

constexpr SamplingOptions kAdaptive{.target_error = 0.02};

/// A ball on a floor that gather the light of an uneven sky, which is plain where it is seen.
Scene ball_under_the_sky() {
    Scene scene = empty_scene(96, 64);
    scene.camera.position = Vec3(0, 1, 8);
    scene.camera.target = Vec3(0, 1, 0);
    scene.environment = GradientEnvironment{Color(0), Color(1)};
    const MaterialId clay = add_material(scene, Diffuse{});
    add_object(scene, Plane{}, clay);
    add_object(scene, Sphere{Vec3(0, 0.8f, 0), 0.8f}, clay);
    return scene;
}

class Render {
public:
    explicit Render(const Scene& scene, int threads = 1)
        : allow_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
          arena_(threads),
          scene_(make_render_scene(scene)),
          tracer_(*scene_, scene.film.width, scene.film.height),
          film(scene.film.width, scene.film.height) {}

    void to(int samples) {
        PassControl control{.cancelled = cancelled_, .paths_done = done};
        arena_.execute([&] { film.add_samples(tracer_, samples, control); });
    }

private:
    tbb::global_control allow_;
    tbb::task_arena arena_;
    std::shared_ptr<const RenderScene> scene_;
    PathTracer tracer_;
    const std::atomic<bool> cancelled_{false};

public:
    Accumulation film;
    std::atomic<std::uint64_t> done{0};
};

constexpr int kMost = 1 << 14;

TEST(AdaptiveFilm, StopsCalmBlocksFirstAndTheRestAtTheTarget) {
    Render render(ball_under_the_sky());
    render.film.set_options(kAdaptive);
    render.to(kMost);
    ASSERT_TRUE(render.film.converged());
    EXPECT_EQ(render.film.unfinished(), 0);
    int least = kMost, most = 0;
    double traced = 0;
    for (const SampledBlock& block : render.film.sampled_blocks()) {
        least = std::min(least, block.samples);
        most = std::max(most, block.samples);
        traced += static_cast<double>(block.x1 - block.x0) * (block.y1 - block.y0) * block.samples;
    }
    EXPECT_EQ(render.film.sampled_blocks().front().samples, AdaptiveBlock::kMinSamples) << "sky";
    EXPECT_EQ(least, AdaptiveBlock::kMinSamples);
    EXPECT_GE(most, 2 * least);
    EXPECT_EQ(most, render.film.samples());
    EXPECT_EQ(traced, static_cast<double>(render.done));
    const SampleSpread spread = render.film.spread();
    EXPECT_DOUBLE_EQ(spread.mean, traced / (96 * 64));
    EXPECT_EQ(spread.finished_pixels, 1);
    EXPECT_EQ(static_cast<double>(spread.saved), 96.0 * 64 * most - traced);
    EXPECT_LE(render.film.film().relative_error(), 0.02 * 0.02);
    EXPECT_TRUE(render.film.rejected_pixels().empty());
}

TEST(AdaptiveFilm, ThreadsAndPassesDoNotChangeTheImage) {
    for (const Scene& scene : {ball_under_the_sky(), mixed_scene(64, 36)}) {
        Render expected(scene), threaded(scene, 3), in_passes(scene);
        for (Render* render : {&expected, &threaded, &in_passes}) render->film.set_options({.target_error = 0.04});
        expected.to(512);
        threaded.to(512);
        for (int samples = 1; samples < 512; samples += 37) in_passes.to(samples);
        in_passes.to(512);
        EXPECT_EQ(means(threaded.film.film()), means(expected.film.film()));
        EXPECT_EQ(means(in_passes.film.film()), means(expected.film.film()));
        EXPECT_EQ(in_passes.film.sampled_blocks(), expected.film.sampled_blocks());
        EXPECT_GT(expected.film.spread().finished_pixels, 0.1);
        EXPECT_LT(expected.film.spread().mean, 500);
    }
}

TEST(AdaptiveFilm, SwitchedOffItBecomesTheImageOfAllSamples) {
    for (const Scene& scene : {ball_under_the_sky(), mixed_scene(64, 36)}) {
        Render adaptive(scene), plain(scene);
        adaptive.film.set_options({.target_error = 0.05});
        adaptive.to(256);
        EXPECT_GT(adaptive.film.spread().finished_pixels, 0.1);
        adaptive.film.set_options({});
        adaptive.to(256);
        plain.to(256);
        EXPECT_EQ(means(adaptive.film.film()), means(plain.film.film()));
        EXPECT_TRUE(adaptive.film.sampled_blocks().empty());
    }
}

TEST(AdaptiveFilm, ASmallerTargetGoesOnFromWhatIsThere) {
    Render render(ball_under_the_sky());
    render.film.set_options({.target_error = 0.05});
    render.to(kMost);
    ASSERT_TRUE(render.film.converged());
    const std::uint64_t before = render.done;
    const double error = render.film.film().relative_error();
    render.film.set_options({.target_error = 0.02});
    EXPECT_FALSE(render.film.converged());
    EXPECT_GE(render.film.samples(), AdaptiveBlock::kMinSamples) << "nothing is thrown away";
    render.to(kMost);
    EXPECT_TRUE(render.film.converged());
    EXPECT_GT(render.done, before);
    EXPECT_LT(render.film.film().relative_error(), 0.5 * error);
    render.film.set_options({.target_error = 0.5});
    EXPECT_TRUE(render.film.converged());
}

TEST(AdaptiveFilm, SwitchedOnLaterItMeasuresFromThere) {
    Render render(ball_under_the_sky());
    render.to(50);
    render.film.set_options(kAdaptive);
    render.to(kMost);
    EXPECT_TRUE(render.film.converged());
    EXPECT_EQ(render.film.sampled_blocks().front().samples, 128) << "the first octave after 50 ends there";
}

TEST(AdaptiveFilm, RestartsAsIfNew) {
    const Scene scene = ball_under_the_sky();
    Render expected(scene), restarted(scene);
    expected.film.set_options(kAdaptive);
    restarted.to(9);
    restarted.film.set_options(kAdaptive);
    restarted.to(100);
    restarted.film.restart();
    EXPECT_EQ(restarted.film.samples(), 0);
    expected.to(512);
    restarted.to(512);
    EXPECT_EQ(means(restarted.film.film()), means(expected.film.film()));
    EXPECT_EQ(restarted.film.sampled_blocks(), expected.film.sampled_blocks());
}

TEST(AdaptiveFilm, SkipTellsWhatFinishedPixelsWouldHaveTaken) {
    Frame frame;
    frame.render_scene = make_render_scene(ball_under_the_sky());
    const auto skip = [&] { return skips_of(frame).back(); };
    EXPECT_EQ(skip().state, SkipState::needed) << "off";
    frame.statistics.adaptive = true;
    EXPECT_EQ(skip().state, SkipState::absent);
    frame.statistics.spread = {.mean = 40, .finished_pixels = 0.5, .saved = 1234};
    EXPECT_EQ(skip().state, SkipState::skipped);
    EXPECT_EQ(skip().saved, 1234u);
}

TEST(Clamp, DarkensInProportion) {
    EXPECT_EQ(clamped(Color(1, 2, 4), 4), Color(1, 2, 4));
    EXPECT_EQ(clamped(Color(2, 4, 8), 4), Color(1, 2, 4));
    EXPECT_TRUE(std::isinf(clamped(Color(1, INFINITY, 1), 4).y)) << "to be rejected and counted";
}

TEST(Clamp, SaysWhatItHasTaken) {
    Scene scene = empty_scene(40, 30);
    scene.environment = ConstantEnvironment{Color(10)};
    Render render(scene);
    render.film.set_options({.clamp = 4});
    render.to(5);
    EXPECT_EQ(render.film.film().mean(7), Vec3d(4));
    EXPECT_NEAR(render.film.clamp_loss().removed, 6, 1e-6);
    EXPECT_NEAR(render.film.clamp_loss().share, 0.6, 1e-6);
    render.film.set_options({.clamp = 20});
    EXPECT_EQ(render.film.samples(), 0) << "another clamp, another image";
    render.to(5);
    EXPECT_EQ(render.film.film().mean(7), Vec3d(10));
    EXPECT_EQ(render.film.clamp_loss().removed, 0);
    render.film.set_options({});
    EXPECT_EQ(render.film.clamp_loss().share, 0);
}

}  // namespace
}  // namespace rayuela
