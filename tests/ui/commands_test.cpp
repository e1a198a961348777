#include "ui/commands.h"
#include "tests/ui/harness.h"
#include "tests/ui/temporary_folder.h"
#include "ui/assets_path.h"
#include "ui/file_actions.h"
#include "ui/object_actions.h"

#include <gmock/gmock.h>

#include <fstream>
#include <set>

namespace rayuela {
namespace {

class CommandTest : public UiTest {
protected:
    /// A small image: these tests are about everything but the rendering.
    CommandTest() : UiTest({900, 560}) {
        editor().view.match_window = false;
        editor().edit(SetFilm{{.width = 96, .height = 64}}, "Size");
        RenderSettings render = scene().render;
        render.max_samples = 2;
        editor().edit(SetRenderSettings{render}, "Limit");
    }

    void choose(const std::string& name) {
        UiTest::run([&](ImGuiTestContext* script) {
            script->ItemInputValue("//###file_dialog/##name", name.c_str());
            script->Yield(2);
        });
    }
};

TEST_F(CommandTest, NamesAndShortcutsAreUnique) {
    std::set<std::pair<std::string, std::string>> names;
    std::set<int> shortcuts;
    for (const Command& command : commands()) {
        EXPECT_TRUE(names.insert({command.menu, command.name}).second) << command.name;
        EXPECT_GT(std::string(command.tip).size(), 5u) << command.name;
        EXPECT_TRUE(std::ranges::find(kMenus, std::string_view(command.menu)) != std::end(kMenus)) << command.name;
        for (const int shortcut : {command.shortcut, command.alternative}) {
            if (shortcut == 0) continue;
            EXPECT_TRUE(shortcuts.insert(shortcut).second) << command.name << ": " << shortcut_text(shortcut);
        }
    }
}

TEST_F(CommandTest, EveryCommandRuns) {
    for (const Command& command : commands()) {
        editor().selection = ball().id;
        rayuela::run(command, editor());
        ASSERT_TRUE(draw_until([] { return true; })) << command.name;
        if (editor().file_dialog.is_open() || editor().unsaved_action) {
            UiTest::run([&](ImGuiTestContext* script) {
                script->KeyPress(ImGuiKey_Escape);
                script->Yield(2);
            });
        }
        ASSERT_FALSE(editor().file_dialog.is_open()) << command.name;
        editor().unsaved_action = nullptr;
        editor().wants_quit = false;
        editor().paused = false;
        while (editor().can_undo() && scene().objects.size() != 2) editor().undo();
        if (scene().objects.size() != 2) {
            while (editor().can_redo() && scene().objects.size() != 2) editor().redo();
        }
        ASSERT_EQ(scene().objects.size(), 2u) << command.name;
    }
}

TEST_F(CommandTest, EveryMenuOpensAndEachItemIsThere) {
    UiTest::run([&](ImGuiTestContext* script) {
        for (const char* menu : kMenus) {
            script->MenuClick((std::string("//##MainMenuBar/") + menu).c_str());
            script->Yield(2);
            for (const Command& command : commands()) {
                if (command.menu != std::string_view(menu)) continue;
                const std::string item = std::string("//$FOCUSED/###") + command.name;
                EXPECT_TRUE(script->ItemExists(item.c_str())) << menu << ": " << command.name;
            }
            script->PopupCloseAll();
        }
    });
}

TEST_F(CommandTest, ShortcutsWaitWhileTextIsTyped) {
    editor().selection = ball().id;
    UiTest::run([&](ImGuiTestContext* script) {
        script->ItemClick("//Inspector/object/##name");
        script->KeyCharsReplaceEnter("xx x");
    });
    ASSERT_EQ(scene().objects.size(), 2u) << "x deletes nothing while it is a letter of a name";
    EXPECT_EQ(ball().name, "xx x");
}

TEST_F(CommandTest, SaveOpenAndRecentFiles) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "saved.scene.json";
    UiTest::run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_S); });
    ASSERT_TRUE(editor().file_dialog.is_open());
    choose((folder.path() / "saved").string());
    ASSERT_FALSE(editor().file_dialog.is_open());
    EXPECT_TRUE(std::filesystem::exists(file)) << "the extension is added to a typed name";
    EXPECT_FALSE(editor().is_modified());
    EXPECT_EQ(editor().file(), file);
    const Scene saved = scene();

    editor().new_scene();
    ASSERT_TRUE(scene().objects.empty());
    UiTest::run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_O); });
    choose(file.string());
    ASSERT_TRUE(draw_until([&] { return !editor().is_loading() && editor().file() == file; }));
    EXPECT_EQ(scene().objects.size(), saved.objects.size());
    EXPECT_EQ(scene().camera, saved.camera);
    EXPECT_EQ(scene().materials.at(0).material, saved.materials.at(0).material);
    EXPECT_EQ(editor().preferences.recent_files.at(0), file.string());
}

TEST_F(CommandTest, OverwritingAsksFirst) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "there.scene.json";
    std::ofstream(file) << "old";
    editor().file_dialog.open({.title = "Save",
                               .extensions = {".scene.json"},
                               .save = true,
                               .chosen = [&](const std::filesystem::path& path) { editor().save_as(path); }},
                              folder.path());
    const auto content = [&] {
        std::ifstream stream(file);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    choose("there");
    EXPECT_TRUE(editor().file_dialog.is_open());
    EXPECT_EQ(content(), "old");
    UiTest::run([&](ImGuiTestContext* script) { script->ItemClick("//###file_dialog/###accept"); });
    EXPECT_FALSE(editor().file_dialog.is_open());
    EXPECT_THAT(content(), testing::HasSubstr("rayuela"));
}

TEST_F(CommandTest, TheDialogWalksThroughFolders) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "inner");
    std::ofstream(folder.path() / "inner" / "a.obj") << "v 0 0 0\n";
    std::ofstream(folder.path() / "inner" / "note.txt") << "no";
    std::filesystem::path chosen;
    editor().file_dialog.open(
        {.title = "Open", .extensions = {".obj"}, .chosen = [&](const std::filesystem::path& path) { chosen = path; }},
        folder.path());
    UiTest::run([&](ImGuiTestContext* script) {
        script->Yield(3);
        script->ItemClick("//###file_dialog/**/###inner");
        script->ItemClick("//###file_dialog/###accept");
        script->Yield(2);
        EXPECT_FALSE(script->ItemExists("//###file_dialog/**/###note.txt"));
        script->ItemClick("//###file_dialog/**/###a.obj");
        script->ItemClick("//###file_dialog/###accept");
    });
    EXPECT_EQ(chosen, folder.path() / "inner" / "a.obj");
}

TEST_F(CommandTest, ABrokenFileLeavesTheSceneAndSaysWhere) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "broken.scene.json";
    std::ofstream(file) << R"({"rayuela": 1, "objects": [{"type": "ball"}]})";
    const Scene before = scene();
    editor().open(file);
    ASSERT_TRUE(draw_until([&] { return !editor().is_loading(); }));
    EXPECT_EQ(scene(), before);
    std::string text;
    for (const LogEntry& entry : editor().log.entries()) text += entry.text + "\n";
    EXPECT_THAT(text, testing::HasSubstr("objects[0].type"));
}

TEST_F(CommandTest, QuitAsksAboutUnsavedWork) {
    ASSERT_TRUE(editor().is_modified());
    UiTest::run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_Q);
        script->Yield(3);
        script->ItemClick("//Save changes?/Cancel");
    });
    EXPECT_FALSE(editor().wants_quit);
    EXPECT_FALSE(editor().unsaved_action);
    UiTest::run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_Q);
        script->Yield(3);
        script->ItemClick("//Save changes?/Don't save");
    });
    EXPECT_TRUE(editor().wants_quit);
}

TEST_F(CommandTest, SavedImageIsWhatIsShown) {
    const TemporaryFolder folder;
    ASSERT_TRUE(draw_until_rendered(2));
    UiTest::run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiKey_F12); });
    choose((folder.path() / "image.exr").string());
    EXPECT_GT(std::filesystem::file_size(folder.path() / "image.exr"), 1000u);
    UiTest::run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiKey_F12); });
    choose((folder.path() / "image").string());
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "image.png"));
}

TEST_F(CommandTest, ExamplesAreListedWithAWord) {
    const std::vector<Example> examples = example_scenes();
    ASSERT_FALSE(examples.empty());
    EXPECT_TRUE(std::ranges::find(examples, "final", &Example::name) != examples.end());
    for (const Example& example : examples)
        EXPECT_FALSE(example.description.empty()) << example.name << " begins with no comment";
}

}  // namespace
}  // namespace rayuela
