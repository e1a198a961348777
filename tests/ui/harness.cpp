#include "tests/ui/harness.h"

#include "core/scene/scene_edit.h"
#include "ui/layout.h"

#include <chrono>
#include <thread>

namespace rayuela {

namespace {

/// The renderer has the processor meanwhile.
constexpr std::chrono::milliseconds kBetweenFrames(RAYUELA_PATIENCE);

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

UiTest::UiTest(glm::ivec2 size, float scale) {
    auto context = make_offscreen_context(size, scale);
    if (!context) throw std::runtime_error(to_string(context.error()));
    context_ = context->get();
    Preferences preferences{.first_start = false};
    preferences.sampling.adaptive = false;  // a scene without a limit is rendered without end
    application_ = std::make_unique<Application>(std::move(*context), std::move(preferences), 2);

    engine_.reset(ImGuiTestEngine_CreateContext());
    ImGuiTestEngineIO& io = ImGuiTestEngine_GetIO(engine_.get());
    io.ConfigRunSpeed = ImGuiTestRunSpeed_Fast;
    io.ConfigVerboseLevel = ImGuiTestVerboseLevel_Warning;
    io.ConfigVerboseLevelOnError = ImGuiTestVerboseLevel_Debug;
    io.ConfigLogToTTY = true;
    io.ConfigSavedSettings = false;
    io.ConfigCaptureEnabled = false;
    io.ConfigMouseDrawCursor = false;
    io.ConfigRestoreFocusAfterTests = false;
    ImGuiTestEngine_Start(engine_.get(), ImGui::GetCurrentContext());

    build_scene();
    draw_until_rendered();
}

UiTest::~UiTest() {
    ImGuiTestEngine_Stop(engine_.get());
    // The engine has to outlive the ImGui context that it is hooked into.
    application_.reset();
}

void UiTest::build_scene() {
    Camera camera;
    camera.position = {0, 1, 5};
    camera.target = {0, 1, 0};
    editor().edit(SetCamera{camera}, "Camera");
    editor().edit(SetEnvironment{ConstantEnvironment{Color(0.8f)}}, "Sky");
    Diffuse red;
    red.albedo.value = Color(0.8f, 0.1f, 0.1f);
    editor().edit(AddMaterial{"Red", red}, "Material");
    Object floor;
    floor.name = "Floor";
    floor.shape = Plane{};
    editor().edit(AddObject{floor}, "Floor");
    Object sphere;
    sphere.name = "Ball";
    sphere.shape = Sphere{Vec3(0, 1, 0), 0.8f};
    sphere.material = scene().materials.at(0).id;
    editor().edit(AddObject{sphere}, "Ball");
}

void UiTest::draw() {
    application_->draw_frame();
    ImGuiTestEngine_PostSwap(engine_.get());
}

void UiTest::run(std::function<void(ImGuiTestContext*)> script) {
    static int count = 0;
    const std::string name = "script " + std::to_string(++count);
    ImGuiTest* const test = ImGuiTestEngine_RegisterTest(engine_.get(), "ui", name.c_str(), __FILE__, __LINE__);
    test->TestFunc = std::move(script);
    ImGuiTestEngine_QueueTest(engine_.get(), test);
    do {
        draw();
    } while (!ImGuiTestEngine_IsTestQueueEmpty(engine_.get()));
    EXPECT_EQ(test->Output.Status, ImGuiTestStatus_Success) << "the script failed, see its log above";
}

bool UiTest::draw_until(const std::function<bool()>& condition, double seconds) {
    const double end = now() + seconds * RAYUELA_PATIENCE;
    for (int frames = 0; frames < 3 || !condition(); ++frames) {
        if (now() > end) return false;
        draw();
        std::this_thread::sleep_for(kBetweenFrames);
    }
    return true;
}

bool UiTest::is_rendered(int spp) {
    const std::shared_ptr<const Frame>& frame = editor().frame();
    const bool current = frame && frame->scene && *frame->scene == editor().shown() && !frame->coarse;
    return current && !editor().is_loading() && frame->statistics.spp >= spp;
}

bool UiTest::draw_until_rendered(int spp) {
    return draw_until([&] { return is_rendered(spp); });
}

bool UiTest::wait_until(ImGuiTestContext* script, const std::function<bool()>& condition, double seconds) {
    const double end = now() + seconds * RAYUELA_PATIENCE;
    for (int frames = 0; frames < 2 || !condition(); ++frames) {
        if (now() > end) return false;
        script->Yield();
        std::this_thread::sleep_for(kBetweenFrames);
    }
    return true;
}

ImRect UiTest::image_rect() {
    const ImGuiWindow& window = *ImGui::FindWindowByName(kViewportName);
    // Between the strips above and below, whose windows are its children.
    ImRect rect = window.Rect();
    for (const ImGuiWindow* child : window.DC.ChildWindows) {
        if (child->Pos.y < rect.GetCenter().y) rect.Min.y = child->Rect().Max.y;
        if (child->Pos.y > rect.GetCenter().y) rect.Max.y = child->Rect().Min.y;
    }
    return rect;
}

Image UiTest::viewport_pixels() {
    const Image window = pixels();
    const ImRect rect = image_rect();
    const int left = static_cast<int>(rect.Min.x), top = static_cast<int>(rect.Min.y);
    Image part{static_cast<int>(rect.GetWidth()), static_cast<int>(rect.GetHeight()), {}, {}};
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) {
            part.pixels.push_back(window.at(left + x, top + y));
        }
    }
    return part;
}

ImVec2 UiTest::viewport_position(float x, float y) {
    const ImRect rect = image_rect();
    return {rect.Min.x + x * rect.GetWidth(), rect.Min.y + y * rect.GetHeight()};
}

void UiTest::drag(ImGuiTestContext* script, Vec2 from, Vec2 to, ImGuiMouseButton button) {
    constexpr int kSteps = 8;
    script->MouseMoveToPos(viewport_position(from.x, from.y));
    script->MouseDown(button);
    for (int i = 1; i <= kSteps; ++i) {
        const Vec2 at = glm::mix(from, to, static_cast<float>(i) / kSteps);
        script->MouseMoveToPos(viewport_position(at.x, at.y));
    }
    script->MouseUp(button);
    script->Yield();
}

float difference(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height || a.pixels.empty()) return 1;
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        sum += max_component(glm::abs(Vec3(a.pixels[i] - b.pixels[i])));
    }
    return static_cast<float>(sum / static_cast<double>(a.pixels.size()));
}

}  // namespace rayuela
