#include "tests/ui/panel_testing.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

TEST_F(PanelTest, EditedMaterialShowsAndUndoBringsBothBack) {
    editor().selection = ball().id;
    const Color before = red_albedo();
    ASSERT_TRUE(draw_until_rendered(4));
    const Image picture = viewport_pixels();
    const std::vector<Vec4> film = editor().frame()->image.pixels;
    const std::uint64_t count = restarts();
    run([&](ImGuiTestContext* script) {
        choose(script, "//Inspector/object/material/##kind", "Metal");
        script->ItemInputValue("//Inspector/object/material/##roughness", 0.25f);
    });
    ASSERT_TRUE(std::holds_alternative<Metal>(red()));
    EXPECT_FLOAT_EQ(std::get<Metal>(red()).roughness.value, 0.25f);
    EXPECT_EQ(std::get<Metal>(red()).albedo.value, before) << "what both kinds have is kept";
    ASSERT_TRUE(draw_until_rendered(4));
    EXPECT_GT(restarts(), count);
    EXPECT_GT(difference(picture, viewport_pixels()), 0.002f);

    run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_Z);
        script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_Z);
    });
    ASSERT_TRUE(std::holds_alternative<Diffuse>(red()));
    ASSERT_TRUE(draw_until_rendered(4));
    EXPECT_EQ(editor().frame()->image.pixels, film) << "the same scene gives the same samples";
    run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiMod_Ctrl | ImGuiMod_Shift | ImGuiKey_Z);
        script->KeyPress(ImGuiMod_Ctrl | ImGuiMod_Shift | ImGuiKey_Z);
    });
    ASSERT_TRUE(std::holds_alternative<Metal>(red()));
    EXPECT_FLOAT_EQ(std::get<Metal>(red()).roughness.value, 0.25f);
}

TEST_F(PanelTest, ADraggedFieldIsOneStepOfUndo) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) { script->ItemDragWithDelta("//Inspector/object/shape/##radius", {40, 0}); });
    EXPECT_GT(std::get<Sphere>(ball().shape).radius, 0.8f);
    editor().undo();
    EXPECT_EQ(std::get<Sphere>(ball().shape).radius, 0.8f);
}

TEST_F(PanelTest, ARefusedValueSnapsBackAndIsLogged) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) {
        script->ItemInputValue("//Inspector/object/shape/##radius", -2.0f);
        script->Yield(2);
    });
    EXPECT_EQ(std::get<Sphere>(ball().shape).radius, 0.8f);
    ASSERT_FALSE(editor().log.entries().empty());
    EXPECT_EQ(editor().log.entries().back().level, LogLevel::error);
    EXPECT_THAT(editor().log.entries().back().text, testing::HasSubstr("radius"));
}

TEST_F(PanelTest, RightClickResetsAField) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) {
        script->ItemClick("//Inspector/object/shape/##radius", ImGuiMouseButton_Right);
        script->ItemClick("//$FOCUSED/Reset to default");
    });
    EXPECT_EQ(std::get<Sphere>(ball().shape).radius, Sphere{}.radius);
}

TEST_F(PanelTest, TransformFieldsMoveTurnAndScale) {
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) {
        script->ItemInputValue("//Inspector/object/transform/translate/##x", 0.5f);
        script->ItemInputValue("//Inspector/object/transform/rotate/##y", 30.0f);
        script->ItemInputValue("//Inspector/object/transform/rotate/##z", 45.0f);
        script->ItemInputValue("//Inspector/object/transform/scale/##y", 2.0f);
    });
    const Transform& transform = ball().transform;
    EXPECT_EQ(transform.translate, Vec3(0.5f, 0, 0));
    EXPECT_EQ(transform.scale, Vec3(1, 2, 1));
    // About y by 30 degrees first, then about z by 45.
    const Vec3 turned = transform.rotate * Vec3(1, 0, 0);
    const float c = std::cos(glm::radians(30.0f)), s = std::sqrt(0.5f);
    EXPECT_LT(glm::distance(turned, Vec3(c * s, c * s, -0.5f)), 1e-5f);
    EXPECT_EQ(editor().panels.euler.degrees, Vec3(0, 30, 45)) << "typed angles stay as typed";
}

TEST_F(PanelTest, MaterialsAreAddedAssignedCopiedAndRemoved) {
    editor().selection = scene().objects[0].id;
    run([&](ImGuiTestContext* script) { script->ItemClick("//Inspector/object/assignment/###new"); });
    ASSERT_EQ(scene().materials.size(), 2u);
    EXPECT_EQ(scene().objects[0].material, scene().materials[1].id);

    run([&](ImGuiTestContext* script) { choose(script, "//Inspector/object/assignment/##assign", "Red"); });
    EXPECT_EQ(scene().objects[0].material, scene().materials[0].id);
    run([&](ImGuiTestContext* script) { script->ItemClick("//Inspector/object/assignment/###copy"); });
    ASSERT_EQ(scene().materials.size(), 3u);
    EXPECT_EQ(scene().materials[2].material, red());
    EXPECT_EQ(scene().objects[0].material, scene().materials[2].id);
    EXPECT_EQ(ball().material, scene().materials[0].id);

    editor().selection.reset();
    editor().selected_material = scene().materials[0].id;
    run([&](ImGuiTestContext* script) { script->ItemClick("//Inspector/materials/###remove"); });
    EXPECT_EQ(scene().materials.size(), 2u);
    EXPECT_FALSE(ball().material) << "users of a removed material become default grey";
    EXPECT_FALSE(editor().selected_material);
}

TEST_F(PanelTest, EnvironmentIsEditedWhenNothingIsSelected) {
    run([&](ImGuiTestContext* script) { choose(script, "//Inspector/environment/##kind", "Gradient"); });
    EXPECT_TRUE(std::holds_alternative<GradientEnvironment>(scene().environment));
    run([&](ImGuiTestContext* script) { choose(script, "//Inspector/environment/##kind", "None"); });
    EXPECT_TRUE(std::holds_alternative<NoEnvironment>(scene().environment));
    ASSERT_TRUE(draw_until_rendered());
    for (const Vec4& pixel : editor().frame()->image.pixels)
        ASSERT_EQ(Color(pixel), Color(0)) << "without light there is none";
    run([&](ImGuiTestContext* script) { choose(script, "//Inspector/environment/##kind", "Image"); });
    EXPECT_TRUE(editor().file_dialog.is_open()) << "an image needs a file";
}

TEST_F(PanelTest, ConstantRadianceIsAColourAndAnIntensity) {
    run([&](ImGuiTestContext* script) {
        script->ItemInputValue("//Inspector/environment/##radiance/##intensity", 4.0f);
    });
    const Color radiance = std::get<ConstantEnvironment>(scene().environment).radiance;
    EXPECT_LT(glm::distance(radiance, Color(4)), 1e-5f);
}

/// While the only light is dragged every frame shows the whole image, and it gets better.
TEST_F(PanelTest, TheOnlyLightIsDraggedAndSamplesGoOn) {
    limit(0);
    editor().edit(SetEnvironment{NoEnvironment{}}, "Night");
    editor().selection = ball().id;
    run([&](ImGuiTestContext* script) { choose(script, "//Inspector/object/material/##kind", "Emitter"); });
    ASSERT_TRUE(draw_until_rendered(4));
    const std::uint64_t count = restarts(), first = statistics().samples;
    const Vec4 glow = editor().frame()->image.pixels[45 * 120 + 60];
    run([&](ImGuiTestContext* script) {
        const char* const intensity = "//Inspector/object/material/##radiance/##intensity";
        script->MouseMove(intensity);
        script->MouseDown();
        std::uint64_t samples = first;
        for (int step = 0; step < 20; ++step) {
            const ImVec2 mouse = ImGui::GetIO().MousePos;
            script->MouseMoveToPos({mouse.x + 4, mouse.y});
            script->Yield();
            const Frame& frame = *editor().frame();
            IM_CHECK(!frame.coarse && frame.statistics.restarts == count && frame.statistics.samples >= samples);
            samples = frame.statistics.samples;
        }
        script->MouseUp();
    });
    const float factor = std::get<Emitter>(red()).radiance.value.x / glow.x;
    EXPECT_GT(factor, 1.2f);
    ASSERT_TRUE(draw_until([&] { return *editor().frame()->scene == scene() && statistics().samples > 2 * first; }));
    EXPECT_EQ(restarts(), count);
    EXPECT_GT(statistics().relit, 3u);
    EXPECT_NEAR(editor().frame()->image.pixels[45 * 120 + 60].x / (factor * glow.x), 1, 1e-5);
}

}  // namespace
}  // namespace rayuela
