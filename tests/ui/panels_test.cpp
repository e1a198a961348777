#include "ui/panels/panels.h"

#include "tests/ui/harness.h"
#include "tests/ui/temporary_folder.h"
#include "ui/commands.h"
#include "ui/object_actions.h"
#include "ui/variants.h"

#include <gmock/gmock.h>

#include <fstream>

namespace rayuela {
namespace {

class PanelTest : public UiTest {
protected:
    /// A small image in a large window.
    PanelTest() : UiTest({1000, 700}) {
        editor().view.match_window = false;
        editor().edit(SetFilm{{.width = 120, .height = 90}}, "Size");
        limit(4);
    }

    void limit(int samples) {
        RenderSettings render = scene().render;
        render.max_samples = samples;
        editor().edit(SetRenderSettings{render}, "Limit");
        draw_until([&] { return is_rendered(samples); });
    }

    static void choose(ImGuiTestContext* script, const char* combo, const char* item) {
        script->ItemClick(combo);
        const ImGuiWindow* popup = script->GetWindowByRef("//$FOCUSED");
        ASSERT_TRUE(popup);
        script->ItemClick((std::string("//") + popup->Name + "/**/" + item).c_str());
    }

    const RenderStatistics& statistics() { return editor().frame()->statistics; }

    /// "//Scene/objects/##5/###object" with the child window's true name.
    static ImGuiTestRef row(ImGuiTestContext* script, ObjectId id, const char* item = "###object") {
        const ImGuiID window = script->WindowInfo("//Scene/objects").ID;
        return script->GetID(("$$" + std::to_string(id.value) + "/" + item).c_str(), window);
    }

    const Material& red() { return scene().materials.at(0).material; }
    const Color& red_albedo() { return std::get<Diffuse>(red()).albedo.value; }
};

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

TEST_F(PanelTest, EveryShapeOfTheListCanBeAdded) {
    for_each_type<Shape>([&]<typename T>() {
        if (needs_file<T>()) return;
        const std::size_t count = scene().objects.size();
        run([&](ImGuiTestContext* script) {
            script->ItemClick("//Scene/###add");
            script->ItemClick(("//$FOCUSED/###" + std::string(T::kType)).c_str());
        });
        ASSERT_EQ(scene().objects.size(), count + 1) << T::kLabel;
        const Object& added = scene().objects.back();
        EXPECT_TRUE(std::holds_alternative<T>(added.shape)) << T::kLabel;
        EXPECT_EQ(editor().selection, added.id);
        editor().selection.reset();
    });
    ASSERT_TRUE(draw_until_rendered());
}

TEST_F(PanelTest, OutlinerSelectsHidesRenamesDuplicatesAndDeletes) {
    const ObjectId id = ball().id;
    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id)); });
    EXPECT_EQ(editor().selection, id);

    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id, "###visible")); });
    EXPECT_FALSE(ball().visible);
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_EQ(std::ranges::count(editor().frame()->object_ids, id.value), 0) << "a hidden object is not rendered";
    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id, "###visible")); });
    EXPECT_TRUE(ball().visible);

    run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiKey_F2);
        script->Yield(2);
        script->KeyCharsReplaceEnter("Marble");
        script->Yield(2);
    });
    EXPECT_EQ(ball().name, "Marble");

    run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_D); });
    ASSERT_EQ(scene().objects.size(), 3u);
    const ObjectId copy = *editor().selection;
    EXPECT_NE(copy, id);
    EXPECT_EQ(scene().find(copy)->shape, scene().find(id)->shape);

    run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiKey_X); });
    EXPECT_FALSE(scene().find(copy));
    EXPECT_FALSE(editor().selection);
}

TEST_F(PanelTest, AnObjectDroppedOnAListGoesIntoIt) {
    editor().selection.reset();
    add_object(editor(), ObjectList{});
    const ObjectId list = *editor().selection, id = ball().id;
    run([&](ImGuiTestContext* script) { script->ItemDragAndDrop(row(script, id), row(script, list)); });
    EXPECT_EQ(scene().find(id)->parent, list);
}

TEST_F(PanelTest, SearchShowsOnlyWhatMatches) {
    editor().panels.scene_filter = "bAl";
    run([&](ImGuiTestContext* script) {
        script->Yield(2);
        EXPECT_TRUE(script->ItemExists(row(script, ball().id)));
        EXPECT_FALSE(script->ItemExists(row(script, scene().objects[0].id)));
    });
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

TEST_F(PanelTest, CameraViewsAndFields) {
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Camera");
        script->ItemClick("//Camera/Top");
    });
    EXPECT_LT(glm::distance(scene().camera.position, Vec3(0, 6, 0)), 1e-5f);
    run([&](ImGuiTestContext* script) { script->ItemInputValue("//Camera/camera/##vfov", 60.0f); });
    EXPECT_EQ(scene().camera.vfov, 60);
    run([&](ImGuiTestContext* script) {
        script->ItemInputValue("//Camera/##width", 320);
        script->ItemInputValue("//Camera/##height", 200);
    });
    EXPECT_EQ(scene().film.width, 320);
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_EQ(editor().frame()->image.width, 320);
    EXPECT_EQ(editor().frame()->image.height, 200);
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

TEST_F(PanelTest, LogFiltersAndClears) {
    editor().log.add(LogLevel::info, "one");
    editor().log.add(LogLevel::error, "two");
    std::string copied;
    run([&](ImGuiTestContext* script) {
        script->WindowFocus("//Log");
        script->ItemClick("//Log/###Messages");
        script->ItemClick("//Log/###copy");
        if (const char* text = ImGui::GetClipboardText()) copied = text;
    });
    EXPECT_THAT(copied, testing::HasSubstr("two"));
    EXPECT_THAT(copied, testing::Not(testing::HasSubstr("one")));
    run([&](ImGuiTestContext* script) { script->ItemClick("//Log/###clear"); });
    EXPECT_TRUE(editor().log.entries().empty());
}

/// Hovers every item of every panel: each must explain itself.
TEST_F(PanelTest, EveryControlHasATooltip) {
    editor().selection = ball().id;
    editor().paused = true;
    editor().health.replays = true;
    editor().health.replayed_pixel = {60, 45};
    ImGui::GetStyle().HoverStationaryDelay = 0;
    ImGui::GetStyle().HoverDelayNormal = ImGui::GetStyle().HoverDelayShort = 0;
    for (const Panel& panel : kPanels) {
        int explained = 0;
        run([&](ImGuiTestContext* script) {
            script->WindowFocus(panel.name);
            ImGuiTestItemList items;
            script->GatherItems(&items, panel.name, 4);
            for (const ImGuiTestItemInfo& item : items) {
                if (!item.Window || item.RectFull.GetWidth() <= 0 || (item.ItemFlags & ImGuiItemFlags_Disabled))
                    continue;
                const std::string label = item.DebugLabel;
                // The empty space below a list needs no words; a plot speaks where its lines are.
                if (label.empty() || label == "##nothing" || label == "##convergence" || label.starts_with("#SCROLL"))
                    continue;
                script->MouseMove(item.ID, ImGuiTestOpFlags_NoError);
                script->Yield(2);
                const ImGuiContext& g = *ImGui::GetCurrentContext();
                if (g.HoveredId != item.ID && g.HoveredIdPreviousFrame != item.ID) continue;
                const ImGuiWindow* tip = ImGui::FindWindowByName("##Tooltip_00");
                const bool shown = tip && (tip->Active || tip->WasActive);
                explained += shown;
                EXPECT_TRUE(shown) << panel.name << ": " << label << " has no tooltip";
            }
        });
        // Statistics has numbers, but no control before there is a curve.
        EXPECT_GE(explained, panel.name == std::string_view("Statistics") ? 0 : 4) << panel.name;
    }
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
