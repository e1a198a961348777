#include "tests/ui/panel_testing.h"
#include "tests/ui/temporary_folder.h"

#include <fstream>

namespace rayuela {
namespace {

TEST_F(PanelTest, LeafSizeChangesTheTreeButNotTheImage) {
    // Many small triangles around the ball, so that there is something to build.
    const TemporaryFolder folder;
    {
        std::ofstream mesh(folder.path() / "grid.obj");
        constexpr int kSide = 40;
        for (int i = 0; i <= kSide; ++i)
            for (int j = 0; j <= kSide; ++j) mesh << "v " << 0.1 * i - 2 << " 0.01 " << 0.1 * j - 2 << '\n';
        for (int i = 0; i < kSide; ++i) {
            for (int j = 0; j < kSide; ++j) {
                const int v = i * (kSide + 1) + j + 1;
                mesh << "f " << v << ' ' << v + 1 << ' ' << v + kSide + 2 << ' ' << v + kSide + 1 << '\n';
            }
        }
    }
    editor().import(folder.path() / "grid.obj");
    ASSERT_TRUE(draw_until([&] { return scene().objects.size() == 3; }));
    ASSERT_TRUE(draw_until_rendered(4));
    ASSERT_EQ(statistics().phase, SessionPhase::finished);
    const std::uint64_t count = restarts();
    const RenderStatistics before = statistics();
    const std::vector<Vec4> pixels = editor().frame()->image.pixels;

    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Render");
        script->ItemDragWithDelta("//Render/##leaf size", {-60, 0});
    });
    EXPECT_LT(scene().render.accel.leaf_size, 16);
    EXPECT_EQ(editor().undo_label(), "Change structure");
    ASSERT_TRUE(draw_until([&] { return statistics().accel.nodes > before.accel.nodes; }));
    EXPECT_GT(statistics().accel.leaves, before.accel.leaves);
    EXPECT_EQ(restarts(), count);
    EXPECT_GE(statistics().spp, 4);
    EXPECT_EQ(editor().frame()->image.pixels, pixels);

    // The other structure and the other split continue with the same picture as well.
    run([&](ImGuiTestContext* script) {
        choose(script, "//Render/##split", "Median");
        choose(script, "//Render/##structure", "List");
    });
    EXPECT_EQ(scene().render.accel.kind, AcceleratorKind::list);
    EXPECT_EQ(scene().render.accel.split, KdSplit::median);
    ASSERT_TRUE(draw_until([&] { return statistics().accel.leaves != before.accel.leaves && is_rendered(4); }));
    EXPECT_EQ(restarts(), count);
    EXPECT_EQ(editor().frame()->image.pixels, pixels);
}

TEST_F(PanelTest, LeafSizeCanBeTypedBeyondTheSlider) {
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Render");
        script->ItemInputValue("//Render/##leaf size", 5000);
    });
    EXPECT_EQ(scene().render.accel.leaf_size, 5000);
}

TEST_F(PanelTest, PauseResumeRestartAndStop) {
    limit(0);
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Render");
        script->ItemClick("//Render/###pause");
    });
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    run([&](ImGuiTestContext* script) { script->ItemClick("//Render/###pause"); });
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::rendering; }));

    const std::uint64_t count = restarts();
    run([&](ImGuiTestContext* script) { script->ItemClick("//Render/###restart"); });
    ASSERT_TRUE(draw_until([&] { return restarts() > count; }));

    run([&](ImGuiTestContext* script) { script->ItemInputValue("//Render/##max samples", 6); });
    EXPECT_EQ(scene().render.max_samples, 6);
    ASSERT_TRUE(draw_until([&] { return statistics().phase == SessionPhase::finished; }));
    EXPECT_EQ(restarts(), count + 1) << "a limit continues what is there";
    EXPECT_GE(statistics().spp, 6);
}

TEST_F(PanelTest, AdaptiveSamplingFinishesAtTheTargetError) {
    EXPECT_TRUE(Preferences().sampling.adaptive) << "on in the window";
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Render");
        script->ItemClick("//Render/##adaptive");
        script->ItemInputValue("//Render/##target error", 2.5f);
    });
    EXPECT_TRUE(editor().sampling.adaptive);
    EXPECT_FLOAT_EQ(editor().sampling.target_error, 0.025f);
    const std::uint64_t count = restarts();
    limit(0);
    ASSERT_TRUE(draw_until([&] { return statistics().phase == SessionPhase::finished; }));
    EXPECT_EQ(statistics().spread.finished_pixels, 1);
    EXPECT_LE(statistics().estimated_error, 1.2 * 0.025 * 0.025);
    const SampleSpread coarse = statistics().spread;
    EXPECT_GE(coarse.mean, 32);

    // Less error, from the samples that are there.
    run([&](ImGuiTestContext* script) { script->ItemInputValue("//Render/##target error", 1.6f); });
    ASSERT_TRUE(draw_until(
        [&] { return statistics().phase == SessionPhase::finished && statistics().spread.mean > 1.5 * coarse.mean; }));
    EXPECT_LE(statistics().estimated_error, 1.2 * 0.016 * 0.016);
    EXPECT_GT(statistics().spread.saved, 0u);

    // Without it there is no end.
    run([](ImGuiTestContext* script) { script->ItemClick("//Render/##adaptive"); });
    EXPECT_FALSE(editor().sampling.adaptive);
    const int most = statistics().spp;
    ASSERT_TRUE(draw_until([&] { return !statistics().adaptive && statistics().spp > most; }));
    EXPECT_EQ(statistics().phase, SessionPhase::rendering);
    EXPECT_EQ(restarts(), count);
}

TEST_F(PanelTest, TheClampSaysWhatItTakes) {
    EXPECT_FALSE(editor().sampling.clamps);
    EXPECT_EQ(statistics().clamp_loss.removed, 0);
    const std::uint64_t count = restarts();
    run([](ImGuiTestContext* script) {
        script->WindowFocus("//Render");
        script->ItemClick("//Render/##clamps");
        script->ItemInputValue("//Render/##clamp", 0.5f);
    });
    // The sky has 0.8.
    ASSERT_TRUE(draw_until([&] { return is_rendered(4) && statistics().clamp_loss.share > 0.01; }));
    EXPECT_GT(restarts(), count);
    EXPECT_EQ(Color(editor().frame()->image.at(60, 2)), Color(0.5f));
    run([](ImGuiTestContext* script) { script->ItemClick("//Render/##clamps"); });
    ASSERT_TRUE(draw_until([&] { return is_rendered(4) && statistics().clamp_loss.removed == 0; }));
    EXPECT_NEAR(editor().frame()->image.at(60, 2).x, 0.8f, 1e-6f);
}

}  // namespace
}  // namespace rayuela
