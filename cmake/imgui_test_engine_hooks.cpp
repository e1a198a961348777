// Dear ImGui compiled with IMGUI_ENABLE_TEST_ENGINE calls these hooks. A program that does not link the test engine gets
// the empty ones below; in one that does, the engine's own take their place, so that both share one build of ImGui.
#include <imgui.h>
#include <imgui_internal.h>

#define WEAK __attribute__((weak))

WEAK void ImGuiTestEngineHook_ItemAdd(ImGuiContext*, ImGuiID, const ImRect&, const ImGuiLastItemData*) {}
WEAK void ImGuiTestEngineHook_ItemInfo(ImGuiContext*, ImGuiID, const char*, ImGuiItemStatusFlags) {}
WEAK void ImGuiTestEngineHook_Log(ImGuiContext*, const char*, ...) {}
WEAK const char* ImGuiTestEngine_FindItemDebugLabel(ImGuiContext*, ImGuiID) {
    return nullptr;
}
