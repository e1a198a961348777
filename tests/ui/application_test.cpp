#include "ui/application.h"
#include "core/io/scene_writer.h"
#include "tests/ui/harness.h"
#include "tests/ui/temporary_folder.h"
#include "ui/panels/panels.h"

#include <gmock/gmock.h>

#include <fstream>

namespace rayuela {
namespace {

constexpr const char* kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class DropTest : public UiTest {
protected:
    std::filesystem::path write(const char* name, const char* text) {
        const std::filesystem::path file = folder.path() / name;
        std::ofstream(file) << text;
        return file;
    }
    bool draw_until_loaded() {
        return draw_until([&] { return !editor().is_loading(); });
    }

    TemporaryFolder folder;
};

TEST_F(DropTest, AFileIsOpenedOnceUnsavedChangesAreDealtWith) {
    const auto file = write("triangle.obj", kMesh);
    application().drop(file);
    ASSERT_TRUE(draw_until_loaded());
    EXPECT_EQ(scene().objects.size(), 2u) << "the scene of the test has never been saved";
    run([](ImGuiTestContext* script) {
        script->SetRef("Save changes?");
        script->ItemClick("Don't save");
    });
    ASSERT_TRUE(draw_until([&] { return editor().file() == file; }));
    ASSERT_EQ(scene().objects.size(), 1u);
    EXPECT_TRUE(std::holds_alternative<Mesh>(scene().objects[0].shape));

    const auto other = write("other.obj", kMesh);
    application().drop(other);
    EXPECT_TRUE(draw_until([&] { return editor().file() == other; })) << "nothing is unsaved, so nothing is asked";
}

TEST_F(DropTest, WithShiftItIsAdded) {
    const auto file = write("triangle.obj", kMesh);
    run([&](ImGuiTestContext* script) {
        script->KeyDown(ImGuiMod_Shift);
        script->Yield();
        application().drop(file);
        script->KeyUp(ImGuiMod_Shift);
    });
    ASSERT_TRUE(draw_until([&] { return scene().objects.size() == 3; }));
    EXPECT_EQ(editor().undo_label(), "Import of triangle.obj");
}

TEST_F(DropTest, WhatIsNoSceneIsRefusedInTheLog) {
    const Scene before = scene();
    editor().edit(SetCamera{before.camera}, "Nothing");
    application().drop(write("notes.txt", "hello"));
    run([](ImGuiTestContext* script) {
        script->SetRef("Save changes?");
        script->ItemClick("Don't save");
    });
    ASSERT_TRUE(draw_until_loaded());
    EXPECT_EQ(scene(), before);
    EXPECT_EQ(editor().log.entries().back().level, LogLevel::error);
}

TEST_F(DropTest, WorkLostInACrashIsOffered) {
    editor().preferences.folder = folder.path();
    Scene lost = scene();
    lost.objects.pop_back();
    ASSERT_TRUE(write_scene(folder.path() / "lost.scene.json", lost));
    editor().panels.show_lost_work = true;
    run([](ImGuiTestContext* script) {
        script->Yield(2);
        script->SetRef("Restore?");
        script->ItemClick("Restore");
        script->SetRef("Save changes?");
        script->ItemClick("Don't save");
    });
    ASSERT_TRUE(draw_until([&] { return scene().objects.size() == 1; }));
    EXPECT_TRUE(editor().is_modified());
    EXPECT_FALSE(editor().panels.show_lost_work);
}

/// The program with a folder for its layout, without the test engine, which keeps none.
class RememberedLayout : public testing::Test {
protected:
    void start() {
        auto context = make_offscreen_context({1280, 720});
        ASSERT_TRUE(context) << to_string(context.error());
        application = std::make_unique<Application>(std::move(*context), load_preferences(folder.path()), 1);
        application->editor().panels.show_quick_start = false;
        draw(5);
    }
    void draw(int frames) {
        for (int i = 0; i < frames; ++i) application->draw_frame();
    }
    void drag(Vec2 from, Vec2 to) {
        ImGuiIO& io = ImGui::GetIO();
        io.AddMousePosEvent(from.x, from.y);
        draw(3);
        io.AddMouseButtonEvent(ImGuiMouseButton_Left, true);
        draw(2);
        io.AddMousePosEvent(to.x, to.y);
        draw(2);
        io.AddMouseButtonEvent(ImGuiMouseButton_Left, false);
        draw(2);
    }
    static ImRect panel(const char* name) { return ImGui::FindWindowByName(name)->Rect(); }

    TemporaryFolder folder;
    std::unique_ptr<Application> application;
};

TEST_F(RememberedLayout, ComesBackWithTheNextStart) {
    ASSERT_NO_FATAL_FAILURE(start());
    const ImRect first = panel("Scene");
    const Vec2 border(first.Max.x + 1, first.GetCenter().y);
    drag(border, border + Vec2(90, 0));
    const ImRect wider = panel("Scene");
    ASSERT_NEAR(wider.GetWidth(), first.GetWidth() + 90, 10);
    application->editor().panels.closed.at(5) = true;
    draw(2);
    application.reset();

    ASSERT_NO_FATAL_FAILURE(start());
    EXPECT_EQ(panel("Scene").GetWidth(), wider.GetWidth());
    EXPECT_THAT(application->editor().panels.closed, testing::Contains(true).Times(1));
    EXPECT_TRUE(application->editor().panels.closed.at(5)) << kPanels[5].name;
    application->editor().view.reset_layout = true;
    draw(5);
    EXPECT_EQ(panel("Scene").GetWidth(), first.GetWidth());
    application.reset();

    std::ofstream(folder.path() / "layout.ini") << "[Docking][Data]\nDockNode ID=0x1 Pos=nan\n[Window][\n\xff\xfe";
    ASSERT_NO_FATAL_FAILURE(start());
    EXPECT_EQ(panel("Scene").GetWidth(), first.GetWidth()) << "damage gives the first layout";
}

}  // namespace
}  // namespace rayuela
