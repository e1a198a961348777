#include "ui/panels/panels.h"

#include "tests/ui/panel_testing.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

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

}  // namespace
}  // namespace rayuela
