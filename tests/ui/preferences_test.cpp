#include "ui/preferences.h"
#include "tests/ui/temporary_folder.h"

#include <gmock/gmock.h>

#include <fstream>

namespace rayuela {
namespace {

TEST(Preferences, ComeBackAsTheyWereSaved) {
    const TemporaryFolder folder;
    Preferences preferences = load_preferences(folder.path() / "new");
    EXPECT_TRUE(preferences.first_start);
    preferences.ui_scale = 1.25f;
    preferences.view.exposure = -1.5f;
    preferences.view.tone_map = ToneMap::agx;
    preferences.view.match_window = false;
    preferences.closed_panels = {"Log"};
    preferences.sampling = {.adaptive = false, .target_error = 0.125f, .clamps = true};
    remember_file(preferences, "/scenes/a.scene.json");
    remember_file(preferences, "/scenes/b.scene.json");
    save_preferences(preferences);

    const Preferences read = load_preferences(folder.path() / "new");
    EXPECT_FALSE(read.first_start);
    EXPECT_EQ(read.ui_scale, 1.25f);
    EXPECT_EQ(read.view.exposure, -1.5f);
    EXPECT_EQ(read.view.tone_map, ToneMap::agx);
    EXPECT_FALSE(read.view.match_window);
    EXPECT_FALSE(read.sampling.adaptive);
    EXPECT_EQ(read.sampling.target_error, 0.125f);
    EXPECT_FALSE(read.sampling.clamps) << "what changes the image is off at the start";
    EXPECT_THAT(read.closed_panels, testing::ElementsAre("Log"));
    EXPECT_THAT(read.recent_files, testing::ElementsAre("/scenes/b.scene.json", "/scenes/a.scene.json"));
}

TEST(Preferences, RecentFilesAreUniqueAndNewestFirst) {
    Preferences preferences;
    for (const char* file : {"/a", "/b", "/a"}) remember_file(preferences, file);
    EXPECT_THAT(preferences.recent_files, testing::ElementsAre("/a", "/b"));
    for (int i = 0; i < 100; ++i) remember_file(preferences, "/" + std::to_string(i));
    EXPECT_EQ(preferences.recent_files.front(), "/99");
    EXPECT_LT(preferences.recent_files.size(), 20u);
}

TEST(Preferences, DamageGivesDefaults) {
    for (const char* text :
         {"", "{", "[]", "null", R"({"ui_scale": "big", "view": 3, "recent_files": {"a": 1}, "closed_panels": 7})",
          R"({"ui_scale": 1e30, "view": {"tone_map": "?", "exposure": []}, "recent_files": [1, null]})"}) {
        const TemporaryFolder folder;
        std::ofstream(folder.path() / "preferences.json") << text;
        const Preferences read = load_preferences(folder.path());
        EXPECT_LE(read.ui_scale, 4) << text;
        EXPECT_EQ(read.view.tone_map, ToneMap::linear) << text;
        EXPECT_EQ(read.view.exposure, 0) << text;
        EXPECT_TRUE(read.recent_files.empty()) << text;
        EXPECT_TRUE(read.closed_panels.empty()) << text;
    }
}

TEST(Preferences, WithoutAFolderNothingIsWritten) {
    save_preferences(Preferences{});
    EXPECT_FALSE(std::filesystem::exists("preferences.json"));
}

}  // namespace
}  // namespace rayuela
