#include "ui/layout.h"

#include "ui/panels/panels.h"

#include <imgui.h>
#include <imgui_internal.h>

namespace rayuela {

namespace {

void build_layout(ImGuiID dockspace) {
    const ImGuiViewport& window = *ImGui::GetMainViewport();
    ImGui::DockBuilderRemoveNode(dockspace);
    ImGui::DockBuilderAddNode(dockspace, ImGuiDockNodeFlags_DockSpace);
    ImGui::DockBuilderSetNodePos(dockspace, window.WorkPos);
    ImGui::DockBuilderSetNodeSize(dockspace, window.WorkSize);

    // Side panels have the width that their contents need, whatever the window's; the viewport takes the rest.
    const float unit = ImGui::GetFontSize();
    const ImVec2 size = window.WorkSize;
    const auto share = [](float wanted, float whole, float most) { return ImMin(wanted / ImMax(whole, 1.0f), most); };
    ImGuiID center = dockspace, left = 0, right = 0, right_bottom = 0, bottom = 0;
    ImGui::DockBuilderSplitNode(center, ImGuiDir_Right, share(22 * unit, size.x, 0.3f), &right, &center);
    ImGui::DockBuilderSplitNode(center, ImGuiDir_Left, share(17.5f * unit, size.x, 0.25f), &left, &center);
    ImGui::DockBuilderSplitNode(center, ImGuiDir_Down, share(11.5f * unit, size.y, 0.3f), &bottom, &center);
    ImGui::DockBuilderSplitNode(right, ImGuiDir_Down, 0.48f, &right_bottom, &right);

    ImGui::DockBuilderDockWindow(kViewportName, center);
    const ImGuiID places[] = {left, right, right_bottom, bottom};
    // The first panel of each place stands in front of the others.
    for (auto panel = kPanels.rbegin(); panel != kPanels.rend(); ++panel) {
        const ImGuiID place = places[static_cast<int>(panel->area)];
        ImGui::DockBuilderDockWindow(panel->name, place);
        ImGui::DockBuilderGetNode(place)->SelectedTabId = ImHashStr("#TAB", 0, ImHashStr(panel->name));
    }
    for (const ImGuiID place : places) {
        // Tabs have a button to close them; one for the whole node would be a second.
        ImGuiDockNode& node = *ImGui::DockBuilderGetNode(place);
        node.SetLocalFlags(node.LocalFlags | static_cast<int>(ImGuiDockNodeFlags_NoCloseButton));
    }
    ImGui::DockBuilderFinish(dockspace);
}

}  // namespace

void draw_dockspace(bool reset) {
    const ImGuiID dockspace = ImGui::GetID("Dockspace");
    const bool remembered = ImGui::DockBuilderGetNode(dockspace) != nullptr;
    if (reset || !remembered) build_layout(dockspace);
    ImGui::DockSpaceOverViewport(dockspace, nullptr, ImGuiDockNodeFlags_NoWindowMenuButton);
}

}  // namespace rayuela
