#include "core/render/progressive_renderer.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <functional>

/// Edits that change the light of all sources by one factor: the image is scaled and its samples go on.
namespace rayuela {
namespace {

using namespace rayuela::testing;

/// A ball of glass and one of clay on a floor, under a lamp that throws caustics.
Scene lamp_scene() {
    Scene scene = empty_scene(48, 36);
    scene.camera.position = Vec3(0, 2, 6);
    scene.camera.target = Vec3(0, 0.5f, 0);
    scene.environment = NoEnvironment{};
    const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(8, 6, 4), nullptr}});
    add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.8f, 0.5f, 0.6f), nullptr}}));
    add_object(scene, Sphere{Vec3(-0.8f, 0.7f, 0), 0.7f}, add_material(scene, Dielectric{}));
    add_object(scene, Sphere{Vec3(0.8f, 0.6f, 0), 0.6f}, scene.materials[1].id);
    add_object(scene, Quad{Vec3(-0.5f, 3, -0.5f), Vec3(1, 0, 0), Vec3(0, 0, 1)}, lamp);
    add_object(scene, Sphere{Vec3(2.6f, 2, 1), 0.2f}, lamp);
    return scene;
}

Scene under(const Environment& sky) {
    Scene scene = lamp_scene();
    scene.objects.resize(3);
    scene.environment = sky;
    return scene;
}

Scene under_a_panorama() {
    Image image{8, 4, {}, "sky"};
    for (int i = 0; i < 32; ++i) image.pixels.push_back(Vec4(i == 10 ? 30.0f : 0.25f * static_cast<float>(i % 3)));
    return under(ImageEnvironment{"sky", std::make_shared<const Image>(image)});
}

/// The scene in other light.
Scene relit(Scene scene, const Color& factor) {
    for (MaterialEntry& entry : scene.materials) {
        if (auto* lamp = std::get_if<Emitter>(&entry.material)) lamp->radiance.value *= factor;
    }
    if (auto* even = std::get_if<ConstantEnvironment>(&scene.environment)) even->radiance *= factor;
    if (auto* sky = std::get_if<GradientEnvironment>(&scene.environment)) {
        sky->bottom *= factor;
        sky->top *= factor;
    }
    if (auto* image = std::get_if<ImageEnvironment>(&scene.environment)) image->scale *= factor.x;
    return scene;
}

/// A session without its thread.
class Renderer {
public:
    explicit Renderer(const Scene& scene, int threads = 1, bool interactive = false) : renderer_(interactive, threads) {
        take(scene);
    }
    void take(const Scene& scene) {
        BuildControl control;
        ASSERT_TRUE(renderer_.take(std::make_shared<const Scene>(scene), control));
    }
    /// To so many samples a pixel, or until it is finished.
    void to(int samples) {
        Scene scene = renderer_.scene();
        scene.render.max_samples = samples;
        take(scene);
        for (Pass pass = renderer_.next_pass(); pass.kind != Pass::Kind::finished; pass = renderer_.next_pass()) {
            if (pass.kind != Pass::Kind::wait) renderer_.render(pass, std::atomic<bool>(false), paths_);
        }
    }
    RenderStatistics statistics() const { return renderer_.statistics(SessionPhase::rendering); }
    std::shared_ptr<const Frame> frame() { return renderer_.publish(SessionPhase::rendering); }
    Image image() { return frame()->image; }
    ProgressiveRenderer* operator->() { return &renderer_; }

private:
    ProgressiveRenderer renderer_;
    std::atomic<std::uint64_t> paths_{0};
};

const std::vector<std::pair<const char*, Scene>>& scenes() {
    static const std::vector<std::pair<const char*, Scene>> all = {
        {"lamp", lamp_scene()},
        {"constant sky", under(ConstantEnvironment{Color(0.5f, 0.7f, 1)})},
        {"gradient", under(GradientEnvironment{})},
        {"panorama", under_a_panorama()},
        {"lamps and sky", mixed_scene(48, 36)}};
    return all;
}

/// With powers of two nothing is rounded, so the film is what it would have been if the light had never been another.
TEST(Relight, ScaledFilmsAreThoseOfTheEditedSceneToTheBit) {
    for (const auto& [name, scene] : scenes()) {
        for (const float factor : {8.0f, 0.25f}) {
            Renderer edited(scene, 2), fresh(relit(scene, Color(factor)));
            edited.to(3);
            edited.take(relit(edited->scene(), Color(factor)));
            EXPECT_EQ(edited.statistics().restarts, 1u) << name;
            EXPECT_EQ(edited.statistics().relit, 1u) << name;
            EXPECT_EQ(edited.statistics().spp, 3) << name;
            fresh.to(3);
            EXPECT_EQ(edited.image().pixels, fresh.image().pixels) << name;
            EXPECT_EQ(edited.statistics().estimated_error, fresh.statistics().estimated_error) << name;
            edited.to(7);
            fresh.to(7);
            EXPECT_EQ(edited.image().pixels, fresh.image().pixels) << name << ", gone on with";
            EXPECT_EQ(edited.statistics().samples, fresh.statistics().samples) << name << ": none was traced twice";
        }
    }
}

TEST(Relight, AColourScalesChannelsAndUndoBringsThemBack) {
    const Scene scene = lamp_scene();
    const Color factor(0.3f, 1.7f, 2.9f);
    Renderer renderer(scene);
    renderer.to(4);
    const Image before = renderer.image();
    renderer.take(relit(renderer->scene(), factor));
    EXPECT_LT(difference(renderer.image(), before, factor), 1e-6);
    for (int i = 0; i < 100; ++i) {
        renderer.take(relit(renderer->scene(), Color(1.1f, 0.3f, 1)));
        renderer.take(scene);
    }
    EXPECT_LT(difference(renderer.image(), before), 1e-6) << "200 edits";
    EXPECT_EQ(renderer.statistics().restarts, 1u);
    EXPECT_EQ(renderer.statistics().relit, 201u);
    EXPECT_EQ(renderer.statistics().samples, 48u * 36 * 4);
}

/// Means over the image of 16 renders by other seeds, some of them edited half way: the same in all channels.
TEST(Relight, TheImageIsThatOfTheEditedScene) {
    for (const auto& [name, scene] : scenes()) {
        const Color factor = std::holds_alternative<ImageEnvironment>(scene.environment) ? Color(3) : Color(0.2f, 1, 3);
        const Scene goal = relit(scene, factor);
        std::array<Vec3d, 2> sum{}, squares{};
        constexpr int kRuns = 16;
        for (std::uint32_t run = 0; run < 2 * kRuns; ++run) {
            Scene start = run % 2 == 0 ? scene : goal;
            start.render.seed = run;
            Renderer renderer(start);
            renderer.to(5);
            Scene end = renderer->scene();
            end.materials = goal.materials;
            end.environment = goal.environment;
            renderer.take(end);
            renderer.to(12);
            ASSERT_EQ(renderer.statistics().restarts, 1u) << name;
            Vec3d mean(0);
            const Image image = renderer.image();
            for (const Vec4& pixel : image.pixels) mean += Vec3d(pixel) / static_cast<double>(image.pixels.size());
            sum[run % 2] += mean;
            squares[run % 2] += mean * mean;
        }
        for (int c = 0; c < 3; ++c) {
            double variance = 0;
            for (std::size_t i = 0; i < 2; ++i)
                variance += (squares[i][c] - sum[i][c] * sum[i][c] / kRuns) / (kRuns - 1) / kRuns;
            EXPECT_LT(std::abs(sum[0][c] - sum[1][c]) / kRuns, 4 * std::sqrt(variance)) << name << ", channel " << c;
        }
    }
}

TEST(Relight, ThreadsDoNotChangeTheImage) {
    Scene scene = lamp_scene();
    // Films are scaled in parts of 16384 pixels.
    scene.film.width = 256;
    scene.film.height = 192;
    std::vector<Vec4> expected;
    for (const int threads : {1, 3, 8}) {
        Renderer renderer(scene, threads);
        renderer.to(1);
        renderer.take(relit(renderer->scene(), Color(0.3f, 1.7f, 2.9f)));
        renderer.to(2);
        if (expected.empty()) expected = renderer.image().pixels;
        EXPECT_EQ(renderer.image().pixels, expected) << threads;
    }
}

/// Whether samples go on when `edit` follows upon two samples of the scene.
bool goes_on(Scene scene, const std::function<void(Scene&)>& edit, const SamplingOptions& sampling = {}) {
    Renderer renderer(scene);
    renderer->set_sampling(sampling);
    renderer.to(2);
    const std::uint64_t restarts = renderer.statistics().restarts;
    scene = renderer->scene();
    edit(scene);
    renderer.take(scene);
    const bool goes_on = renderer.statistics().restarts == restarts;
    EXPECT_EQ(renderer.statistics().spp, goes_on ? 2 : 0);
    return goes_on;
}

/// A film whose passes are over at once: of a round of light paths each does one batch, of the samples one of a tile.
class BriefPasses {
public:
    explicit BriefPasses(const Scene& scene) : film_(scene.film.width, scene.film.height) { show(scene); }
    void show(const Scene& scene) {
        scene_ = make_render_scene(scene);
        tracer_.emplace(*scene_, scene.film.width, scene.film.height);
    }
    /// One pass. Not parallel, so that it is over after the first batch.
    void pass(int samples) {
        PassControl control{.cancelled = cancelled_, .paths_done = done_};
        control.stop_at = std::chrono::steady_clock::now() + std::chrono::microseconds(200);
        tbb::task_arena(1).execute([&] { counts_ += film_.add_samples(*tracer_, samples, control); });
        ++passes_;
    }
    Accumulation& film() { return film_; }
    const RayCounts& counts() const { return counts_; }
    int passes() const { return passes_; }
    std::uint32_t lamp_paths_a_round() const { return tracer_->light_tracer()->paths(); }

private:
    Accumulation film_;
    std::shared_ptr<const RenderScene> scene_;
    std::optional<PathTracer> tracer_;
    RayCounts counts_;
    int passes_ = 0;
    const std::atomic<bool> cancelled_{false};
    std::atomic<std::uint64_t> done_{0};
};

TEST(Relight, BriefPassesEndWithinARoundOfLampPathsAndGoOn) {
    Scene scene = lamp_scene();
    scene.film.width = 384;
    scene.film.height = 288;
    const Scene brighter = relit(scene, Color(4));
    for (const bool edits : {false, true}) {
        BriefPasses brief(scene);
        const std::uint32_t batches = (brief.lamp_paths_a_round() + 4095) / 4096;
        ASSERT_GT(batches, 1u);
        while (brief.film().samples() < 1) brief.pass(1);
        brief.pass(2);
        EXPECT_EQ(brief.film().film().rounds(), 1u);
        EXPECT_GT(brief.counts().lamp_paths, brief.lamp_paths_a_round()) << "within the second round";
        if (edits) {
            ASSERT_TRUE(brief.film().scale_light(Vec3d(4)));
            brief.show(brighter);
        }
        while (brief.film().samples() < 2) brief.pass(2);
        EXPECT_EQ(brief.counts().lamp_paths, 2 * brief.lamp_paths_a_round()) << "none twice";
        EXPECT_GE(brief.passes(), static_cast<int>(2 * batches));
        const auto expected = render(edits ? brighter : scene, 2);
        EXPECT_EQ(means(brief.film().film()), means(expected->film()));
    }
}

TEST(Relight, RestartsWhereTheImageIsNotScaled) {
    const auto brighter = [](Scene& scene) { scene = relit(scene, Color(2)); };
    EXPECT_TRUE(goes_on(lamp_scene(), brighter));
    EXPECT_FALSE(goes_on(lamp_scene(), brighter, {.clamp = 5})) << "another share of the samples would be clamped";
    EXPECT_FALSE(goes_on(mixed_scene(48, 36), [](Scene& scene) {
        std::get<Emitter>(scene.materials[5].material).radiance.value *= 2.0f;
    })) << "the lamps but not the sky";
    const auto to_red = [](Scene& scene) { scene = relit(scene, Color(1, 0, 0)); };
    EXPECT_TRUE(goes_on(lamp_scene(), to_red));
    const auto from_red = [](Scene& scene) { scene.materials[0].material = Emitter{}; };
    EXPECT_FALSE(goes_on(relit(lamp_scene(), Color(1, 0, 0)), from_red)) << "of green and blue nothing is known";
    EXPECT_FALSE(goes_on(relit(lamp_scene(), Color(0)), from_red)) << "switched on";
}

TEST(Relight, RestartsWhereSamplesHaveBeenRejected) {
    auto sky = std::make_shared<Image>(Image{2, 1, {Vec4(1), Vec4(INFINITY)}, "sky"});
    const auto brighter = [](Scene& scene) { std::get<ImageEnvironment>(scene.environment).scale *= 2; };
    EXPECT_FALSE(goes_on(under(ImageEnvironment{"sky", sky}), brighter));
}

/// Of caustics camera paths leave a share to paths from lamps: it must not change while the one or the other has more.
TEST(Relight, RestartsWherePathsLeaveLampsOfOtherColoursInOtherShares) {
    const auto redder = [](Scene& scene) { scene = relit(scene, Color(4, 1, 1)); };
    const auto brighter = [](Scene& scene) { scene = relit(scene, Color(0.3f)); };
    Scene scene = lamp_scene();
    EXPECT_TRUE(goes_on(scene, redder)) << "of one colour: as much of either as before";
    scene.objects.back().material = add_material(scene, Emitter{.radiance = {Color(2, 6, 9), nullptr}});
    ASSERT_NE(make_render_scene(scene)->emission(), nullptr);
    EXPECT_FALSE(goes_on(scene, redder));
    EXPECT_TRUE(goes_on(scene, brighter));
    scene.materials[2].material = Diffuse{};  // instead of glass
    EXPECT_TRUE(goes_on(scene, redder));
}

TEST(Relight, RestartsBeforeAllPixelsHaveASample) {
    Renderer renderer(lamp_scene());
    renderer.take(relit(lamp_scene(), Color(2)));
    EXPECT_EQ(renderer.statistics().restarts, 2u);
}

TEST(Relight, WhatNothingVisibleHasNeverRestarts) {
    const auto spare = [](Scene& scene) { add_material(scene, Emitter{}); };
    EXPECT_TRUE(goes_on(lamp_scene(), spare));
    EXPECT_TRUE(goes_on(lamp_scene(), spare, {.clamp = 5}));
    Renderer renderer(lamp_scene());
    Scene scene = lamp_scene();
    spare(scene);
    renderer.take(scene);
    EXPECT_EQ(renderer.statistics().restarts, 1u);
    EXPECT_EQ(renderer.statistics().relit, 0u);
}

/// The window shows the scaled image before anything is traced, and no preview.
TEST(Relight, IsShownAtOnce) {
    Scene scene = lamp_scene();
    Renderer renderer(scene, 1, true);
    renderer.to(4);
    ASSERT_EQ(renderer.frame()->statistics.spp, 4);
    scene.render.max_samples = 0;
    renderer.take(scene);
    const Image before = renderer.image();
    ASSERT_FALSE(renderer->publication_due());
    renderer.take(relit(scene, Color(2)));
    EXPECT_EQ(renderer->next_pass().kind, Pass::Kind::brief);
    ASSERT_TRUE(renderer->publication_due());
    const auto frame = renderer.frame();
    EXPECT_FALSE(frame->coarse);
    EXPECT_EQ(difference(frame->image, before, Color(2)), 0);
    EXPECT_FALSE(renderer->publication_due());
}

constexpr SamplingOptions kAdaptive{.target_error = 0.03};

TEST(Relight, AdaptiveSamplingGoesOnToTheTarget) {
    for (const Color& factor : {Color(16), Color(0.01f), Color(0.02f, 0.5f, 9)}) {
        Renderer renderer(lamp_scene());
        renderer->set_sampling(kAdaptive);
        renderer.to(1 << 14);
        ASSERT_EQ(renderer.statistics().spread.finished_pixels, 1);
        const Image before = renderer.image();
        const std::uint64_t samples = renderer.statistics().samples;
        renderer.take(relit(renderer->scene(), factor));
        Renderer fresh(renderer->scene());
        fresh->set_sampling(kAdaptive);
        fresh.to(1 << 14);
        EXPECT_EQ(renderer.statistics().restarts, 1u);
        EXPECT_LT(difference(renderer.image(), before, factor), 1e-6);
        renderer.to(1 << 14);
        renderer.frame();
        EXPECT_LT(renderer.statistics().estimated_error, 1.2 * 0.03 * 0.03);
        EXPECT_EQ(renderer.statistics().spread.finished_pixels, 1);
        EXPECT_LT(renderer.statistics().samples, 1.5 * std::max(samples, fresh.statistics().samples));
        EXPECT_EQ(renderer.statistics().restarts, 1u);
    }
}

/// As if the edited scene's image had been measured from the beginning.
TEST(Relight, NoiseOfScaledBlocksIsThatOfScaledSamples) {
    AdaptiveBlock scaled(1), fresh(1);
    const double factor = 0.02;
    for (AdaptiveBlock* block : {&scaled, &fresh}) block->start_measuring(0);
    for (std::uint32_t sample = 0; sample < 32; ++sample) {
        const float y = 1 + 0.5f * static_cast<float>((sample * 7) % 5);
        scaled.measure(0, sample, y);
        fresh.measure(0, sample, y * static_cast<float>(factor));
    }
    for (AdaptiveBlock* block : {&scaled, &fresh}) {
        block->update_noise(32);
        block->set_shown(32);
    }
    for (std::size_t half = 0; half < 2; ++half) EXPECT_GT(scaled.deviation(half), 2 * fresh.deviation(half));
    scaled.scale({factor, factor});
    for (std::size_t half = 0; half < 2; ++half)
        EXPECT_NEAR(scaled.deviation(half) / fresh.deviation(half), 1, 1e-6) << half;

    // Stopped, but not where twice the noise is allowed for.
    const std::array<double, 2> mean{scaled.deviation(0), scaled.deviation(1)};
    const double target = scaled.deviation(0);
    scaled.stop_where_enough(32, mean, target);
    ASSERT_TRUE(scaled.stopped());
    EXPECT_FALSE(scaled.stopped_too_early(mean, target));
    EXPECT_TRUE(scaled.stopped_too_early(mean, target / 10));
}

}  // namespace
}  // namespace rayuela
