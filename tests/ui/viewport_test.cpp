#include "tests/ui/harness.h"

#include "core/math/srgb.h"
#include "ui/camera_control.h"
#include "ui/tone_map.h"

#include <glad/glad.h>
#include <gmock/gmock.h>

namespace rayuela {
namespace {

constexpr Vec2 kMiddle(0.5f, 0.5f), kSky(0.5f, 0.06f);

TEST(NextSelection, ClimbsThroughTheGroupsAndStartsAgain) {
    Scene scene;
    for (std::uint32_t i = 1; i <= 3; ++i) {
        Object object;
        object.id = {i};
        object.parent = {i - 1};
        if (i < 3) object.shape = ObjectList{};
        scene.objects.push_back(object);
    }
    const ObjectId outer{1}, inner{2}, ball{3}, other{9};
    EXPECT_EQ(next_selection(scene, {}, ball), ball);
    EXPECT_EQ(next_selection(scene, other, ball), ball);
    EXPECT_EQ(next_selection(scene, ball, ball), inner);
    EXPECT_EQ(next_selection(scene, inner, ball), outer);
    EXPECT_EQ(next_selection(scene, outer, ball), ball);
}

class ViewportTest : public UiTest {
protected:
    ViewportTest() : UiTest({1100, 640}) {}
};

TEST_F(ViewportTest, FilmTakesTheSizeOfTheViewport) {
    const ImRect rect = image_rect();
    EXPECT_EQ(editor().frame()->image.width, static_cast<int>(rect.GetWidth()));
    EXPECT_EQ(editor().frame()->image.height, static_cast<int>(rect.GetHeight()));
    EXPECT_FALSE(editor().scene().film.width == editor().shown().film.width);
}

TEST_F(ViewportTest, ShowsTheFilmPixelForPixel) {
    editor().paused = true;
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    for (const ToneMap tone_map :
         {ToneMap::linear, ToneMap::aces, ToneMap::agx, ToneMap::filmic, ToneMap::false_color}) {
        editor().view.tone_map = tone_map;
        editor().view.exposure = 0.5f;
        ASSERT_TRUE(draw_until([] { return true; }));
        const Image shown = viewport_pixels();
        const Image& film = editor().frame()->image;
        ASSERT_EQ(shown.width, film.width);
        ASSERT_EQ(shown.height, film.height);
        // At the left lies the scale of the false colours; the tolerance is rounding to 8 bits.
        for (int y = 5; y < film.height; y += 3) {
            for (int x = 120; x < film.width; x += 3) {
                const Color expected = tone_mapped(Color(film.at(x, y)), 0.5f, tone_map);
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_NEAR(shown.at(x, y)[channel], linear_to_srgb(expected[channel]), 1.6f / 255)
                        << kToneMapNames[static_cast<int>(tone_map)] << " at " << x << ", " << y;
                }
            }
        }
    }
}

TEST_F(ViewportTest, OrbitByDragChangesTheCameraAndThePicture) {
    const Image before = viewport_pixels();
    const Camera camera = scene().camera;
    const std::uint64_t count = restarts();
    run([&](ImGuiTestContext* script) { drag(script, kMiddle, {0.65f, 0.4f}); });
    EXPECT_NE(scene().camera.position, camera.position);
    EXPECT_EQ(scene().camera.target, camera.target);
    EXPECT_NEAR(glm::distance(scene().camera.position, camera.target), 5, 1e-3f);
    EXPECT_LT(scene().camera.position.x, 0) << "the scene follows the mouse to the right";
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_GT(restarts(), count);
    EXPECT_GT(difference(before, viewport_pixels()), 0.004f);

    EXPECT_EQ(editor().undo_label(), "Orbit");
    editor().undo();
    EXPECT_EQ(scene().camera, camera) << "a drag is one step";
}

TEST_F(ViewportTest, PanDollyAndFly) {
    const Camera start = scene().camera;
    run([&](ImGuiTestContext* script) { drag(script, kMiddle, {0.6f, 0.5f}, ImGuiMouseButton_Middle); });
    EXPECT_LT(scene().camera.target.x, start.target.x);
    EXPECT_EQ(editor().undo_label(), "Pan");
    editor().undo();
    run([&](ImGuiTestContext* script) {
        script->KeyDown(ImGuiMod_Shift);
        drag(script, kMiddle, {0.5f, 0.4f});
        script->KeyUp(ImGuiMod_Shift);
    });
    EXPECT_LT(scene().camera.target.y, start.target.y);
    editor().undo();
    EXPECT_EQ(scene().camera, start);
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(0.5f, 0.5f));
        script->MouseWheelY(1);
        script->MouseWheelY(1);
    });
    EXPECT_LT(glm::distance(scene().camera.position, start.target), 4.5f);
    EXPECT_EQ(scene().camera.target, start.target);
    editor().undo();
    EXPECT_EQ(scene().camera, start) << "notches of the wheel are one step";
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(0.5f, 0.5f));
        script->MouseDown(ImGuiMouseButton_Right);
        script->KeyHold(ImGuiKey_W, 0.2f);
        script->MouseUp(ImGuiMouseButton_Right);
    });
    EXPECT_LT(scene().camera.position.z, start.position.z);
    EXPECT_EQ(editor().undo_label(), "Fly");
    EXPECT_EQ(editor().view.gizmo, GizmoMode::none);
}

TEST_F(ViewportTest, LookingDifferentlyNeverRestarts) {
    ASSERT_TRUE(draw_until_rendered(2));
    const std::uint64_t count = restarts();
    const int spp = editor().frame()->statistics.spp;
    const Image before = viewport_pixels();
    run([&](ImGuiTestContext* script) {
        script->SetRef(script->WindowInfo("//Viewport/toolbar").Window);
        script->ItemDragWithDelta("##exposure", {60, 0});
        script->ComboClick("##tone_map/AgX");
        script->MouseMoveToPos(viewport_position(0.5f, 0.5f));
        script->MouseClick();
        script->ItemClick("###outline");
        script->KeyDown(ImGuiMod_Ctrl);
        script->MouseMoveToPos(viewport_position(0.4f, 0.5f));
        script->MouseWheelY(2);
        script->KeyUp(ImGuiMod_Ctrl);
    });
    EXPECT_GT(editor().view.exposure, 0.5f);
    EXPECT_EQ(editor().view.tone_map, ToneMap::agx);
    EXPECT_TRUE(editor().selection.has_value());
    EXPECT_FALSE(editor().view.show_outline);
    EXPECT_FALSE(editor().view.fit);
    EXPECT_GT(difference(before, viewport_pixels()), 0.01f);
    ASSERT_TRUE(draw_until_rendered(spp + 1));
    EXPECT_EQ(restarts(), count);
}

TEST_F(ViewportTest, ClickSelectsWhatIsUnderTheMouse) {
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(kMiddle.x, kMiddle.y));
        script->MouseClick();
        script->Yield(2);
    });
    ASSERT_TRUE(editor().selection.has_value());
    EXPECT_EQ(*editor().selection, ball().id);
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(0.5f, 0.97f));
        script->MouseClick();
        script->Yield(2);
    });
    EXPECT_EQ(editor().selection, scene().objects.at(0).id) << "the floor";
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(kSky.x, kSky.y));
        script->MouseClick();
        script->Yield(2);
    });
    EXPECT_FALSE(editor().selection.has_value());
}

TEST_F(ViewportTest, ADragSelectsNothing) {
    run([&](ImGuiTestContext* script) { drag(script, kMiddle, {0.55f, 0.5f}); });
    EXPECT_FALSE(editor().selection.has_value());
}

TEST_F(ViewportTest, TheSelectedObjectHasAnOutline) {
    editor().paused = true;
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    const Image before = viewport_pixels();
    editor().selection = ball().id;
    ASSERT_TRUE(draw_until([] { return true; }));
    const Image after = viewport_pixels();
    int changed = 0;
    for (int y = 0; y < after.height; ++y) {
        for (int x = 0; x < after.width; ++x) {
            if (glm::distance(Vec3(before.at(x, y)), Vec3(after.at(x, y))) < 0.02f) continue;
            ++changed;
            // By projection the ball is a disc of radius tan(asin(0.8 / 5)) / (2 tan 20 deg) image heights.
            const float radius = std::tan(std::asin(0.8f / 5)) / (2 * std::tan(glm::radians(20.0f)));
            const Vec2 offset(static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(after.width),
                              static_cast<float>(y) + 0.5f - 0.5f * static_cast<float>(after.height));
            ASSERT_NEAR(glm::length(offset), radius * static_cast<float>(after.height), 5);
        }
    }
    EXPECT_GT(changed, 300);
}

TEST_F(ViewportTest, DoubleClickFocusesWithoutMovingThePicture) {
    const Camera before = scene().camera;
    run([&](ImGuiTestContext* script) {
        ImGui::GetIO().MouseSingleClickDelay = 61;
        ImGui::GetIO().MouseDoubleClickTime = 60;  // Two clicks are one double click however slow the machine.
        script->MouseMoveToPos(viewport_position(kMiddle.x, kMiddle.y));
        script->MouseDoubleClick();
        script->Yield(2);
    });
    EXPECT_NEAR(scene().camera.focus_distance, 5 - 0.8f, 0.02f);
    EXPECT_EQ(scene().camera.position, before.position);
    EXPECT_NEAR(glm::distance(scene().camera.target, Vec3(0, 1, 0.8f)), 0, 0.03f);
    EXPECT_EQ(editor().undo_label(), "Focus");
}

TEST_F(ViewportTest, FrameSelectedFillsTheView) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(kMiddle.x, kMiddle.y));
        script->KeyPress(ImGuiKey_F);
        script->Yield(2);
    });
    EXPECT_LT(glm::distance(scene().camera.target, Vec3(0, 1, 0)), 1e-3f);
    EXPECT_LT(glm::distance(scene().camera.position, scene().camera.target), 5);
    ASSERT_TRUE(draw_until_rendered());
    // The ball's id reaches far, but not to the border.
    const Frame& frame = *editor().frame();
    const auto row = static_cast<std::size_t>(frame.image.height / 2) * static_cast<std::size_t>(frame.image.width);
    const auto seen =
        std::count(frame.object_ids.begin() + static_cast<std::ptrdiff_t>(row),
                   frame.object_ids.begin() + static_cast<std::ptrdiff_t>(row) + frame.image.width, ball().id.value);
    EXPECT_GT(seen, frame.image.height / 3);
    EXPECT_LT(seen, frame.image.width);
}

TEST_F(ViewportTest, EscapeDeselects) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) {
        script->MouseMoveToPos(viewport_position(kMiddle.x, kMiddle.y));
        script->KeyPress(ImGuiKey_Escape);
        script->Yield(2);
    });
    EXPECT_FALSE(editor().selection.has_value());
}

TEST_F(ViewportTest, ADragOfTheGizmoIsOneStepOfUndo) {
    editor().selection = ball().id;
    editor().view.gizmo = GizmoMode::translate;
    const Object before = ball();
    // The arrow to the right starts at the ball's middle: its length is a fixed part of the image.
    run([&](ImGuiTestContext* script) {
        script->Yield(2);
        drag(script, {0.535f, 0.5f}, {0.62f, 0.5f});
    });
    EXPECT_GT(ball().transform.translate.x, 0.1f);
    EXPECT_NEAR(ball().transform.translate.y, 0, 1e-4f);
    EXPECT_NEAR(ball().transform.translate.z, 0, 1e-4f);
    EXPECT_EQ(editor().undo_label(), "Move");
    EXPECT_EQ(scene().camera.position, Vec3(0, 1, 5)) << "the drag did not orbit";
    editor().undo();
    EXPECT_EQ(ball(), before);
}

TEST_F(ViewportTest, ZoomShowsPixelsAsSquares) {
    editor().paused = true;
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    editor().view.fit = false;
    editor().view.zoom = 16;
    ASSERT_TRUE(draw_until([] { return true; }));
    const Image shown = viewport_pixels();
    const Image& film = editor().frame()->image;
    // The middle of the film stays in the middle: its origin is rounded to whole pixels.
    const int left = static_cast<int>(std::round(0.5f * static_cast<float>(shown.width - 16 * film.width)));
    const int top = static_cast<int>(std::round(0.5f * static_cast<float>(shown.height - 16 * film.height)));
    for (int y = 0; y < shown.height; y += 5) {
        for (int x = 0; x < shown.width; x += 5) {
            const Color value(film.at((x - left) / 16, (y - top) / 16));
            const float expected = linear_to_srgb(tone_mapped(value, 0, ToneMap::linear).x);
            ASSERT_NEAR(shown.at(x, y).x, expected, 1.6f / 255) << x << ", " << y;
        }
    }
}

TEST_F(ViewportTest, AClosedPanelGivesItsRoomToTheFilm) {
    const int width = editor().frame()->image.width;
    editor().panels.closed[0] = true;
    ASSERT_TRUE(draw_until([&] { return editor().shown().film.width > width; }, 5));
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_EQ(editor().frame()->image.width, static_cast<int>(image_rect().GetWidth()));
    EXPECT_FALSE(editor().is_modified() && editor().undo_label() == "Film");
    editor().view.reset_layout = true;
    ASSERT_TRUE(draw_until([&] { return editor().shown().film.width == width; }, 5));
}

TEST_F(ViewportTest, WhatDoesNotChangeIsNeitherUploadedNorDrawn) {
    editor().paused = true;
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    ASSERT_TRUE(draw_until([] { return true; }));
    const Display::Statistics before = application().display_statistics();
    ASSERT_TRUE(draw_until([] { return true; }));
    EXPECT_EQ(application().display_statistics().uploads, before.uploads);
    EXPECT_EQ(application().display_statistics().draws, before.draws);
    editor().view.exposure = 1;
    ASSERT_TRUE(draw_until([] { return true; }));
    EXPECT_EQ(application().display_statistics().uploads, before.uploads);
    EXPECT_EQ(application().display_statistics().draws, before.draws + 1);
}

TEST_F(ViewportTest, ScreenshotIsWhatTheWindowShows) {
    editor().paused = true;
    ASSERT_TRUE(draw_until([&] { return editor().session().status().phase == SessionPhase::paused; }));
    run([&](ImGuiTestContext* script) { script->MouseMoveToPos({2, 2}); });
    const Image shown = pixels();
    EXPECT_LT(difference(shown, application().screenshot(0)), 1e-4f);
}

TEST_F(ViewportTest, APreviewIsDrawnSmallAndInItsPlace) {
    Scene scene;
    scene.film.width = 400;
    scene.film.height = 200;
    Frame frame;
    frame.version = 1;
    frame.scene = std::make_shared<const Scene>(scene);
    frame.image = {40, 20, std::vector<Vec4>(40 * 20, Vec4(1)), {}};
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) frame.image.pixels[static_cast<std::size_t>(40 * y + x)] = Vec4(0, 0, 0, 1);
    }
    Display display;
    DisplayRequest request;
    request.size = {433, 251};
    request.origin = {10, 20};
    for (const bool coarse : {true, false}) {
        frame.coarse = coarse;
        ++frame.version;
        const Display::Picture picture = display.draw(std::make_shared<const Frame>(frame), request);
        glBindTexture(GL_TEXTURE_2D, picture.texture);
        int width = 0, height = 0;
        glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &width);
        glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &height);
        if (coarse) {
            EXPECT_LT(width * height, 433 * 251 / 10);
        } else {
            EXPECT_EQ(glm::ivec2(width, height), request.size);
        }
        std::vector<std::uint8_t> texels(static_cast<std::size_t>(4 * width * height));
        glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
        const auto shown = [&](Vec2 position) {
            const Vec2 uv = glm::mix(Vec2(0, 1), picture.lower_right, position / Vec2(request.size));
            const glm::ivec2 at = glm::clamp(glm::ivec2(uv * Vec2(width, height)), {0, 0}, {width - 1, height - 1});
            return int{texels[static_cast<std::size_t>(4 * (at.y * width + at.x))]};
        };
        for (const float y : {26.0f, 120.0f, 214.0f}) {
            EXPECT_LT(shown({16, y}), 5) << y;
            EXPECT_LT(shown({200, y}), 5) << y;
            EXPECT_GT(shown({220, y}), 250) << y;
            EXPECT_GT(shown({404, y}), 250) << y;
            for (const float x : {4.0f, 416.0f}) EXPECT_NEAR(shown({x, y}), 17, 4) << "beside the image " << x;
        }
        for (const float y : {14.0f, 226.0f}) EXPECT_NEAR(shown({300, y}), 17, 4) << "above or below the image " << y;
    }
}

TEST_F(ViewportTest, OnlyChangedTilesAreUploaded) {
    Scene scene;
    scene.film.width = 200;
    scene.film.height = 130;
    Frame frame;
    frame.scene = std::make_shared<const Scene>(scene);
    frame.image = {200, 130, std::vector<Vec4>(200 * 130, Vec4(0.1f, 0.2f, 0.3f, 1)), {}};
    Display display;
    DisplayRequest request;
    request.size = {200, 130};
    std::uint64_t uploaded = 0;
    const auto pixels_of_next = [&] {
        ++frame.version;
        display.draw(std::make_shared<const Frame>(frame), request);
        return display.statistics().uploaded_pixels - std::exchange(uploaded, display.statistics().uploaded_pixels);
    };
    const auto texture_is_the_image = [&] {
        std::vector<std::uint8_t> texels(200 * 130 * 4);
        glBindTexture(GL_TEXTURE_2D, display.draw(std::make_shared<const Frame>(frame), request).texture);
        glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
        for (int y = 0; y < 130; ++y) {
            for (int x = 0; x < 200; ++x) {
                const float expected = linear_to_srgb(frame.image.at(x, y).x) * 255;
                const auto at = static_cast<std::size_t>(4 * (200 * (129 - y) + x));
                if (std::abs(static_cast<float>(texels[at]) - expected) > 1.6f) return false;
            }
        }
        return true;
    };
    EXPECT_EQ(pixels_of_next(), 200u * 130u);
    EXPECT_EQ(pixels_of_next(), 0u) << "another version of the same";
    // Tiles have 64 pixels a side: the first, and two neighbours in the last row of tiles, which is 2 pixels high.
    frame.image.at(63, 63).x = 0.8f;
    EXPECT_EQ(pixels_of_next(), 64u * 64u);
    frame.image.at(191, 129).x = 0.7f;
    frame.image.at(192, 128).x = 0.6f;
    EXPECT_EQ(pixels_of_next(), (64u + 8u) * 2u);
    EXPECT_TRUE(texture_is_the_image());
    for (Vec4& pixel : frame.image.pixels) pixel.x *= 0.5f;
    EXPECT_EQ(pixels_of_next(), 200u * 130u);
    EXPECT_TRUE(texture_is_the_image());
}

class DenseDisplayTest : public UiTest {
protected:
    DenseDisplayTest() : UiTest({1800, 1100}, 2) {}
};

TEST_F(DenseDisplayTest, TextAndPanelsGrowWithTheScale) {
    EXPECT_NEAR(ImGui::FindWindowByName("Inspector")->FontRefSize, 2 * 15.5f, 1);
    EXPECT_GT(ImGui::FindWindowByName("Inspector")->Size.x, 400);
    editor().preferences.ui_scale = 0.5f;
    ASSERT_TRUE(draw_until([] { return true; }));
    EXPECT_NEAR(ImGui::FindWindowByName("Inspector")->FontRefSize, 15.5f, 1);
}

}  // namespace
}  // namespace rayuela
