#include "ui/health.h"
#include "core/math/float_error.h"
#include "core/math/srgb.h"
#include "core/scene/scene_edit.h"
#include "tests/ui/harness.h"
#include "ui/background.h"
#include "ui/map_colors.h"
#include "ui/pixel_values.h"

#include <gmock/gmock.h>

#include <thread>

namespace rayuela {
namespace {

constexpr Vec2 kBall(0.5f, 0.5f), kSky(0.5f, 0.06f);

class HealthTest : public UiTest {
protected:
    HealthTest() : UiTest({1200, 700}) { limit(3); }

    void limit(int samples) {
        RenderSettings render = scene().render;
        render.max_samples = samples;
        editor().edit(SetRenderSettings{render}, "Limit");
        draw_until([&] { return is_rendered(samples); });
    }

    Health& health() { return editor().health; }

    void choose_map(const std::string& name) {
        run([&](ImGuiTestContext* script) {
            script->SetRef(script->WindowInfo("//Viewport/toolbar").Window);
            script->ComboClick(("##tone_map/" + name).c_str());
        });
    }
    /// Until the map of the scene on screen is there, and nothing more is being done.
    bool draw_until_mapped() {
        return draw_until([&] {
            return is_rendered() && health().picture() && !health().is_busy() &&
                   health().picture()->render_scene == editor().frame()->render_scene;
        });
    }
    glm::ivec2 pixel(const Vec2& at) {
        return glm::ivec2(at * Vec2(editor().shown().film.width, editor().shown().film.height));
    }
    /// The value there, and that the viewport shows its colour.
    float shown_value(const Vec2& at) {
        const glm::ivec2 place = pixel(at);
        const float value = health().value(place).value();
        const Color expected = map_color(editor().view.map, value);
        const Vec4 displayed = viewport_pixels().at(place.x, place.y);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(displayed[channel], linear_to_srgb(expected[channel]), 0.6 / 255) << "of value " << value;
        return value;
    }
    /// The ball shines with what is infinite once it is multiplied out.
    void break_ball() {
        Principled material;
        material.emissive.value = Color(1e30f);
        material.emissive_strength = 1e30f;
        MaterialEntry entry = scene().materials.at(0);
        entry.material = material;
        ASSERT_TRUE(editor().edit(SetMaterial{entry}, "Break"));
        ASSERT_TRUE(draw_until_rendered(3));
    }
};

TEST_F(HealthTest, MapOfPositionErrorsIsMadeWhileItIsLookedAt) {
    EXPECT_FALSE(health().picture()) << "nothing is worked out unasked";
    EXPECT_FALSE(health().is_busy());
    const std::uint64_t count = restarts();
    editor().view.exposure = 3;  // of the image alone
    choose_map("Position error");
    EXPECT_EQ(editor().view.map, ViewMap::position_error);
    ASSERT_TRUE(draw_until_mapped());
    // The ball's front is at (0, 1, 0.8), seen from 4.2 away: between the rounding of its coordinates and twice that.
    const float ball = shown_value(kBall), relative = std::hypot(1.0f, 0.8f) / 4.2f;
    EXPECT_GT(ball, 0.5f * kUnitRoundoff * relative);
    EXPECT_LT(ball, 4 * kUnitRoundoff * relative);
    EXPECT_TRUE(std::isnan(shown_value(kSky)));
    EXPECT_EQ(restarts(), count);
    EXPECT_EQ(editor().frame()->statistics.spp, 3) << "the samples are still there";

    choose_map("Linear");
    EXPECT_EQ(editor().view.map, ViewMap::image);
    EXPECT_FALSE(health().picture());
    EXPECT_EQ(restarts(), count);
}

TEST_F(HealthTest, MapFollowsTheCamera) {
    editor().view.map = ViewMap::position_error;
    ASSERT_TRUE(draw_until_mapped());
    const float before = shown_value(kBall);
    Camera camera = scene().camera;
    camera.position.z = 50;
    editor().edit(SetCamera{camera}, "Away");
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_LT(shown_value(kBall), 0.2f * before) << "the same point from twelve times the distance";
}

TEST_F(HealthTest, FloatAndDoubleAgreeOnTheView) {
    choose_map("Float vs double");
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_LE(shown_value(kBall), 1.01f * kUnitRoundoff);
    EXPECT_TRUE(std::isnan(shown_value(kSky)));
    const FilmSettings& film = editor().shown().film;
    for (int y = 0; y < film.height; y += 3) {
        for (int x = 0; x < film.width; x += 3) {
            const float value = health().value({x, y}).value();
            EXPECT_TRUE(std::isnan(value) || value <= 1.01f * kUnitRoundoff) << x << ", " << y << ": " << value;
        }
    }
}

TEST_F(HealthTest, RejectedSamplesAreCountedAndShownWhereTheyAre) {
    choose_map("Rejections");
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_EQ(shown_value(kBall), 0);
    break_ball();
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_EQ(shown_value(kBall), 3);
    EXPECT_EQ(shown_value(kSky), 0);
    const auto& rejected = editor().frame()->statistics.rejected;
    EXPECT_GT(rejected[static_cast<std::size_t>(Rejection::infinite)], 0u);
    std::uint64_t samples = 0;
    for (const RejectedPixel& p : editor().frame()->rejected_pixels) samples += p.samples;
    EXPECT_EQ(samples, rejected[0] + rejected[1] + rejected[2]);

    // Undone, all samples are good again.
    editor().undo();
    ASSERT_TRUE(draw_until_rendered(3));
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_EQ(shown_value(kBall), 0);
    EXPECT_TRUE(editor().frame()->rejected_pixels.empty());
}

TEST_F(HealthTest, MapOfSamplesShowsWhereTheyWent) {
    choose_map("Samples");
    EXPECT_EQ(editor().view.map, ViewMap::samples);
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_EQ(shown_value(kBall), 3);
    EXPECT_EQ(shown_value(kSky), 3);
    editor().sampling = {.adaptive = true, .target_error = 0.01f};
    limit(0);
    ASSERT_TRUE(draw_until([&] { return editor().frame()->statistics.phase == SessionPhase::finished; }));
    ASSERT_TRUE(draw_until_mapped());
    EXPECT_EQ(shown_value(kSky), 32) << "plain background needs no more";
    EXPECT_GT(shown_value(kBall), 32);
}

TEST_F(HealthTest, PathsAreMeasuredOnDemandForOneScene) {
    const std::uint64_t count = restarts();
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Health");
        EXPECT_EQ(health().measured(), nullptr);
        script->ItemClick("//Health/###measure");
    });
    ASSERT_TRUE(draw_until([&] { return health().measured() != nullptr; }));
    const PathHealth& measured = *health().measured();
    EXPECT_EQ(measured.paths, 20'000u);
    EXPECT_GT(measured.scattered_rays, 10'000u);
    EXPECT_EQ(measured.self_hits, 0u);
    EXPECT_EQ(measured.energy_tests, 5u) << "one material, which does not transmit";
    EXPECT_EQ(measured.above_one, 0u);
    EXPECT_EQ(restarts(), count);
    Camera camera = scene().camera;
    camera.position.x = 1;
    editor().edit(SetCamera{camera}, "Aside");
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_EQ(health().measured(), nullptr) << "counts of another scene";
}

TEST_F(HealthTest, AClickReplaysASampleOfThePixel) {
    const std::uint64_t count = restarts();
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Health");
        script->ItemClick("//Health/###replay");
        script->MouseMoveToPos(viewport_position(kBall.x, kBall.y));
        script->MouseClick();
        script->Yield(2);
    });
    EXPECT_FALSE(editor().selection.has_value()) << "the click is the replay's";
    ASSERT_TRUE(health().replayed());
    const Replay& first = *health().replayed();
    ASSERT_GE(first.rows.size(), 2u);
    EXPECT_EQ(first.rows[0].object, "Ball (0)");
    EXPECT_EQ(first.rows[0].material, "diffuse");
    EXPECT_EQ(first.id.sample, 0u);
    const RenderScene& shown = *editor().frame()->render_scene;
    EXPECT_EQ(first.radiance, trace_one(shown, first.id));
    const Color before = first.radiance;

    std::string copied;
    run([&](ImGuiTestContext* script) {
        script->ItemInputValue("//Health/##sample", 7);
        script->Yield(2);
        script->ItemClick("//Health/###copy");
        if (const char* text = ImGui::GetClipboardText()) copied = text;
    });
    EXPECT_EQ(health().replayed()->id.sample, 7u);
    EXPECT_EQ(health().replayed()->radiance, trace_one(shown, {first.id.pixel, 7}));
    EXPECT_NE(health().replayed()->radiance, before);
    EXPECT_EQ(copied, to_text(*health().replayed()));

    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(kSky.x, kSky.y));
        script->MouseClick();
        script->Yield(2);
    });
    EXPECT_EQ(health().replayed()->rows.at(0).object, "environment");
    EXPECT_LT(glm::distance(health().replayed()->radiance, Color(0.8f)), 1e-6f);
    EXPECT_EQ(restarts(), count);

    run([&](ImGuiTestContext* script) {
        script->ItemClick("//Health/###replay");
        script->MouseMoveToPos(viewport_position(kBall.x, kBall.y));
        script->MouseClick();
    });
    EXPECT_FALSE(health().replayed());
    EXPECT_EQ(editor().selection, ball().id);
}

/// The replay of a sample tells why it was rejected.
TEST_F(HealthTest, AReplayShowsTheInfiniteLight) {
    break_ball();
    health().replays = true;
    health().replayed_pixel = pixel(kBall);
    ASSERT_TRUE(draw_until([&] { return health().replayed() != nullptr; }));
    EXPECT_EQ(health().replayed()->rows.at(0).light, "(inf inf inf)");
    EXPECT_FALSE(is_finite(health().replayed()->radiance));
}

TEST_F(HealthTest, ThePanelChoosesTheMapToo) {
    const auto choose = [&](const char* item) {
        run([&](ImGuiTestContext* script) {
            script->WindowFocus("//Health");
            script->SetRef("//Health");
            script->ComboClick(item);
        });
    };
    choose("##map/Position error");
    EXPECT_EQ(editor().view.map, ViewMap::position_error);
    choose("##map/Image");
    EXPECT_EQ(editor().view.map, ViewMap::image);
}

TEST(MapColors, RunFromBlueToRedByTheLogarithm) {
    const Color low = map_color(ViewMap::position_error, 1e-9f), high = map_color(ViewMap::position_error, 1e-3f);
    EXPECT_EQ(map_color(ViewMap::position_error, 1e-20f), low);
    EXPECT_EQ(map_color(ViewMap::position_error, 1), high);
    EXPECT_EQ(map_color(ViewMap::retrace, 0), low);
    EXPECT_GT(high.x, high.z);
    EXPECT_GT(scale_color(0.2f).z, scale_color(0.2f).x);
    EXPECT_NE(map_color(ViewMap::retrace, kInfinity), map_color(ViewMap::retrace, 1));
    EXPECT_NE(map_color(ViewMap::rejected, 0), map_color(ViewMap::rejected, 1)) << "one rejected sample can be seen";
    EXPECT_EQ(map_value_text(ViewMap::samples, 64), "64 samples");
    EXPECT_NE(map_color(ViewMap::samples, 32), map_color(ViewMap::samples, 64));
    EXPECT_EQ(map_value_text(ViewMap::rejected, 12), "12 rejected");
    EXPECT_EQ(map_value_text(ViewMap::position_error, 2e-7f), "error 2.00e-07");
    EXPECT_EQ(map_value_text(ViewMap::retrace, kInfinity), "float and double differ");
}

TEST(Background, DoesOneThingAtATimeAndStopsWhenTold) {
    Background<int> background;
    EXPECT_FALSE(background.is_busy());
    background.start([](const std::atomic<bool>& cancelled) {
        while (!cancelled) std::this_thread::yield();
        return 5;
    });
    EXPECT_TRUE(background.is_busy());
    EXPECT_FALSE(background.take());
    background.cancel();
    std::optional<int> result;
    while (!result) result = background.take();
    EXPECT_EQ(result, 5);
    EXPECT_FALSE(background.is_busy());
    // What is under way when it goes is told to stop.
    background.start([](const std::atomic<bool>& cancelled) {
        while (!cancelled) std::this_thread::yield();
        return 0;
    });
}

}  // namespace
}  // namespace rayuela
