#pragma once

#include "tests/ui/harness.h"

#include <string>

namespace rayuela {

/// Panels beside a small image of four samples a pixel.
class PanelTest : public UiTest {
protected:
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

}  // namespace rayuela
