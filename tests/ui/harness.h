#pragma once

#include "ui/application.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_te_context.h>
#include <imgui_te_engine.h>

#include <functional>

namespace rayuela {

/// The whole program in an off-screen window, driven by scripts of the ImGui test engine: a script moves the mouse and
/// presses keys as a person does, while frames are drawn as in the window. Nothing is read from or written to the disk.
class UiTest : public testing::Test {
protected:
    /// Starts with the layout of a first start and a red ball in the middle of the image, on a grey floor under a white
    /// sky: objects "Floor" and "Ball".
    explicit UiTest(glm::ivec2 size = {1280, 720}, float scale = 1);
    ~UiTest() override;

    Application& application() { return *application_; }
    Editor& editor() { return application_->editor(); }
    const Scene& scene() { return editor().scene(); }

    /// Runs a script to its end, a frame at a time; its failed checks fail the test.
    void run(std::function<void(ImGuiTestContext*)> script);
    /// Draws until the condition holds; false after so many seconds (more under a sanitizer).
    bool draw_until(const std::function<bool()>& condition, double seconds = 20);
    /// Draws until a full-resolution image of the current scene with at least `spp` samples is on screen.
    bool draw_until_rendered(int spp = 1);
    /// The same from within a script.
    static bool wait_until(ImGuiTestContext* script, const std::function<bool()>& condition, double seconds = 20);
    bool is_rendered(int spp = 1);

    /// What the window shows, and the part of it that is the viewport's image. Not from within a script, which runs on a
    /// thread without the OpenGL context.
    Image pixels() const { return context_->read_pixels(); }
    Image viewport_pixels();
    /// The position in the window of a point of the viewport's image, (0, 0) its upper left corner and (1, 1) the lower right.
    ImVec2 viewport_position(float x, float y);
    /// Drags in the viewport's image between two such points.
    void drag(ImGuiTestContext* script, Vec2 from, Vec2 to, ImGuiMouseButton button = ImGuiMouseButton_Left);

    std::uint64_t restarts() { return editor().frame() ? editor().frame()->statistics.restarts : 0; }
    const Object& ball() { return scene().objects.at(1); }
    /// Position and size of the viewport's image in the window.
    ImRect image_rect();

private:
    struct EngineDeleter {
        void operator()(ImGuiTestEngine* engine) const { ImGuiTestEngine_DestroyContext(engine); }
    };
    void draw();
    void build_scene();

    GlContext* context_ = nullptr;
    std::unique_ptr<ImGuiTestEngine, EngineDeleter> engine_;
    std::unique_ptr<Application> application_;
};

/// Mean over all pixels of the largest difference of a channel; 1 where the sizes differ.
float difference(const Image& a, const Image& b);

}  // namespace rayuela
