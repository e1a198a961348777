#include "tests/render_testing.h"
#include "tests/support/scaled_scene.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace rayuela {
namespace {

using namespace rayuela::testing;

constexpr int kWidth = 75, kHeight = 70, kSamples = 3;

TEST(Determinism, ThreadsDoNotChangeTheImage) {
    const Scene scene = mixed_scene(kWidth, kHeight);
    const auto expected = means(render(scene, kSamples)->film());
    for (const int threads : {2, 3, 5, 8}) {
        EXPECT_EQ(means(render(scene, kSamples, {}, threads)->film()), expected) << threads << " threads";
    }
}

TEST(Determinism, PassesDoNotChangeTheImage) {
    const Scene scene = mixed_scene(kWidth, kHeight);
    const auto in_passes = [&](std::initializer_list<int> counts) {
        Passes passes(scene);
        for (const int samples : counts) passes.render_to(samples);
        return means(passes.film().film());
    };
    EXPECT_EQ(in_passes({6}), in_passes({1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(in_passes({6}), in_passes({4, 6}));
}

/// Passes cut short at random, on a film of many tiles, leave no trace once the missing samples have come.
TEST(Determinism, InterruptionsDoNotChangeTheImage) {
    const Scene scene = mixed_scene(160, 130);
    const auto render_scene = make_render_scene(scene);
    const PathTracer tracer(*render_scene, 160, 130);
    Accumulation film(160, 130);
    std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> done{0};
    int cuts = 0;
    for (int milliseconds = 0; film.samples() < 2; ++milliseconds, ++cuts) {
        PassControl control{.cancelled = cancelled,
                            .paths_done = done,
                            .stop_at = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds)};
        film.add_samples(tracer, 2, control);
    }
    EXPECT_GT(cuts, 1);
    EXPECT_EQ(means(film.film()), means(render(scene, 2)->film()));
}

TEST(Determinism, CancelledPathsAreNotAdded) {
    const Scene scene = mixed_scene(kWidth, kHeight);
    const auto render_scene = make_render_scene(scene);
    Accumulation film(kWidth, kHeight);
    const std::atomic<bool> cancelled{true};
    std::atomic<std::uint64_t> done{0};
    PassControl control{.cancelled = cancelled, .paths_done = done};
    film.add_samples(PathTracer(*render_scene, kWidth, kHeight), 1, control);
    EXPECT_EQ(film.samples(), 0);
    EXPECT_EQ(done, 0u);
    PathBatch batch;
    batch.ids = {{0, 0}, {1, 0}};
    EXPECT_FALSE(PathTracer(*render_scene, kWidth, kHeight).trace(batch, cancelled));
}

TEST(Determinism, AcceleratorsDoNotChangeTheImage) {
    Scene scene = mixed_scene(kWidth, kHeight);
    scene.render.accel = {.kind = AcceleratorKind::list};
    const auto expected = means(render(scene, kSamples)->film());
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        for (const int leaf_size : {1, 3, 16, 64, 5000}) {
            scene.render.accel = {.kind = AcceleratorKind::kd, .leaf_size = leaf_size, .split = split};
            EXPECT_EQ(means(render(scene, kSamples)->film()), expected) << "leaf size " << leaf_size;
        }
    }
}

TEST(Determinism, OneSampleReplaysAlone) {
    for (const SamplerKind sampler : {SamplerKind::independent, SamplerKind::sobol}) {
        Scene scene = mixed_scene(kWidth, kHeight);
        scene.render.sampler = sampler;
        scene.camera.lens_radius = 0.05f;
        // What paths from lamps bring belongs to no sample.
        const PathTracerOptions options{.light_tracing = false};
        const auto film = render(scene, 1, options);
        const auto render_scene = make_render_scene(scene);
        for (std::uint32_t pixel = 0; pixel < kWidth * kHeight; pixel += 37) {
            EXPECT_EQ(Vec3d(trace_one(*render_scene, {pixel, 0}, options)), film->film().mean(pixel))
                << "pixel " << pixel;
        }
    }
}

TEST(Determinism, CompanyInABatchDoesNotMatter) {
    // A large mirror beside a lamp: paths split, and parts of one path meet diffuse things and others.
    Scene caustics = mixed_scene(kWidth, kHeight);
    add_object(caustics, Sphere{Vec3(0.5f, 2.2f, 0.5f), 0.05f}, add_material(caustics, Emitter{{Color(900), nullptr}}));
    add_object(caustics, Sphere{Vec3(-1, 1, -1), 1}, add_material(caustics, Metal{}));
    for (const Scene& scene : {mixed_scene(kWidth, kHeight), caustics}) {
        const auto render_scene = make_render_scene(scene);
        const PathTracer tracer(*render_scene, kWidth, kHeight);
        const std::atomic<bool> cancelled{false};
        PathBatch ordered, shuffled;
        for (std::uint32_t i = 0; i < 6000; ++i) ordered.ids.push_back({i % (kWidth * kHeight), i % 5});
        std::vector<std::uint32_t> order(ordered.ids.size());
        std::iota(order.begin(), order.end(), 0u);
        std::shuffle(order.begin(), order.end(), std::mt19937(7));
        for (const std::uint32_t i : order) shuffled.ids.push_back(ordered.ids[i]);
        tracer.trace(ordered, cancelled);
        tracer.trace(shuffled, cancelled);
        EXPECT_FALSE(ordered.part_paths.empty());
        ASSERT_EQ(shuffled.radiance.size(), order.size());
        for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(shuffled.radiance[i], ordered.radiance[order[i]]);
    }
}

/// Powers of two scale every number exactly, so nothing in the renderer may know how large a metre is.
TEST(Determinism, ScaleDoesNotChangeTheImage) {
    const Scene scene = mixed_scene(kWidth, kHeight);
    const auto expected = means(render(scene, kSamples)->film());
    for (const float scale : {0x1p-20f, 0x1p-3f, 0x1p20f}) {
        EXPECT_EQ(means(render(scaled_by(scene, scale), kSamples)->film()), expected) << "scale " << scale;
    }
}

TEST(Determinism, SeedsAndSamplersGiveDifferentNoise) {
    Scene scene = mixed_scene(kWidth, kHeight);
    const auto first = means(render(scene, 1)->film());
    scene.render.seed = 1;
    EXPECT_NE(means(render(scene, 1)->film()), first);
    scene.render.seed = 0;
    scene.render.sampler = SamplerKind::independent;
    EXPECT_NE(means(render(scene, 1)->film()), first);
}

}  // namespace
}  // namespace rayuela
