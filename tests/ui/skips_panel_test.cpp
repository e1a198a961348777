#include "core/render/skips.h"
#include "tests/ui/harness.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rayuela {
namespace {

class SkipsPanelTest : public UiTest {
protected:
    SkipsPanelTest() : UiTest({1000, 700}) {
        editor().view.match_window = false;
        editor().edit(SetFilm{{.width = 120, .height = 90}}, "Size");
        RenderSettings render = scene().render;
        render.max_samples = 2;
        editor().edit(SetRenderSettings{render}, "Limit");
        draw_until_rendered(2);
        run([](ImGuiTestContext* script) { script->WindowFocus("//Skips"); });
    }

    Skip skip(std::string_view name) {
        const std::vector<Skip> skips = skips_of(*editor().frame());
        return *std::ranges::find(skips, name, &Skip::name);
    }

    std::vector<Vec4> panel() {
        const Image window = pixels();
        const ImRect rect = ImGui::FindWindowByName("Skips")->InnerRect;
        std::vector<Vec4> part;
        for (int y = static_cast<int>(rect.Min.y); y < static_cast<int>(rect.Max.y); ++y)
            for (int x = static_cast<int>(rect.Min.x); x < static_cast<int>(rect.Max.x); ++x)
                part.push_back(window.at(x, y));
        return part;
    }
};

TEST_F(SkipsPanelTest, FollowsTheScene) {
    const std::vector<Vec4> with_sky = panel();
    editor().edit(SetEnvironment{NoEnvironment{}}, "Night");
    draw_until_rendered(2);
    const std::vector<Vec4> without = panel();
    ASSERT_EQ(with_sky.size(), without.size());
    EXPECT_NE(with_sky, without);
    EXPECT_EQ(skip("Bounces").state, SkipState::skipped);
    EXPECT_EQ(skip("Bounces").counter(editor().frame()->statistics), 0u);
}

TEST_F(SkipsPanelTest, ABoxPutsWorkBackAndTheImageStays) {
    const Image before = editor().frame()->image;
    const std::uint64_t count = restarts();
    EXPECT_EQ(skip("Textures").counter(editor().frame()->statistics), 0u);
    run([](ImGuiTestContext* script) { script->ItemClick("//Skips/**/ready_materials/skipped"); });
    ASSERT_TRUE(draw_until([&] { return restarts() > count && is_rendered(2); }));
    EXPECT_EQ(skip("Textures").state, SkipState::put_back);
    EXPECT_GT(skip("Textures").counter(editor().frame()->statistics), 0u);
    EXPECT_EQ(editor().frame()->image.pixels, before.pixels);

    run([](ImGuiTestContext* script) { script->ItemClick("//Skips/**/Skip all again"); });
    ASSERT_TRUE(draw_until([&] { return restarts() > count + 1 && is_rendered(2); }));
    EXPECT_EQ(skip("Textures").state, SkipState::skipped);
    EXPECT_EQ(editor().frame()->image.pixels, before.pixels);
}

}  // namespace
}  // namespace rayuela
