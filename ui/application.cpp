#include "ui/application.h"

#include "ui/commands.h"
#include "ui/frame_pacing.h"
#include "ui/imgui_session.h"
#include "ui/layout.h"
#include "ui/panels/panels.h"
#include "ui/theme.h"
#include "ui/viewport.h"

#include <glad/glad.h>

// glad first: it takes the place of the system's OpenGL header.
#include <GLFW/glfw3.h>
// ImGuizmo.h needs imgui.h before it.
#include <imgui.h>

#include <ImGuizmo.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
#include <imgui_internal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace rayuela {

namespace {

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct Application::Impl {
    Impl(std::unique_ptr<GlContext> gl_context, Preferences preferences, int threads);
    ~Impl();

    void draw(bool present);
    void begin_imgui_frame();
    void update_theme();
    void draw_panels();
    std::uint64_t held_gesture();
    void update_title();
    void drop(const std::filesystem::path& file);
    bool wait_and_decide(FrameTiming& timing);

    std::unique_ptr<GlContext> context;
    Editor editor;
    ImGuiSession imgui;
    Viewport viewport;
    float theme_scale = 0;
    double last_frame = now_seconds();
    std::uint64_t presses = 0;
    double last_wheel = -1e9;
    std::string title;
    bool refresh = true;
    std::atomic<bool> published{false};
};

Application::Impl::Impl(std::unique_ptr<GlContext> gl_context, Preferences preferences, int threads)
    : context(std::move(gl_context)),
      editor(std::move(preferences), threads),
      imgui(*context, editor.preferences.folder) {
    for (std::size_t i = 0; i < kPanels.size(); ++i) {
        editor.panels.closed[i] = std::ranges::count(editor.preferences.closed_panels, kPanels[i].name) > 0;
    }
    if (GLFWwindow* const window = context->window()) {
        glfwSetWindowUserPointer(window, this);
        glfwSetDropCallback(window, [](GLFWwindow* target, int count, const char** paths) {
            for (int i = 0; i < count; ++i) {
                static_cast<Impl*>(glfwGetWindowUserPointer(target))->drop(paths[i]);
            }
        });
        glfwSetWindowRefreshCallback(
            window, [](GLFWwindow* target) { static_cast<Impl*>(glfwGetWindowUserPointer(target))->refresh = true; });
        editor.session().on_publish([this] {
            published = true;
            glfwPostEmptyEvent();
        });
    }
}

Application::Impl::~Impl() {
    editor.session().on_publish({});
    editor.preferences.closed_panels.clear();
    for (std::size_t i = 0; i < kPanels.size(); ++i) {
        if (editor.panels.closed[i]) editor.preferences.closed_panels.emplace_back(kPanels[i].name);
    }
}

void Application::Impl::update_theme() {
    const float framebuffer_scale = std::max(ImGui::GetIO().DisplayFramebufferScale.x, 0.1f);
    const float scale = std::clamp(context->scale() / framebuffer_scale * editor.preferences.ui_scale, 0.25f, 8.0f);
    if (scale == theme_scale) return;
    apply_theme(scale);
    theme_scale = scale;
}

void Application::Impl::begin_imgui_frame() {
    ImGuiIO& io = ImGui::GetIO();
    ImGui_ImplOpenGL3_NewFrame();
    if (context->window()) {
        ImGui_ImplGlfw_NewFrame();
    } else {
        const Vec2 size(context->framebuffer_size());
        io.DisplaySize = {size.x, size.y};
        const double now = now_seconds();
        io.DeltaTime = static_cast<float>(std::max(now - last_frame, 1e-6));
        last_frame = now;
    }
    update_theme();
    ImGui::NewFrame();
    ImGuizmo::BeginFrame();
}

/// Identity of what mouse or keyboard hold. Each press of the mouse is its own; its release still belongs to it, because
/// buttons act then. Notches of the wheel shortly after each other are one.
std::uint64_t Application::Impl::held_gesture() {
    const ImGuiIO& io = ImGui::GetIO();
    const auto any = [](const bool(&buttons)[ImGuiMouseButton_COUNT]) {
        return std::ranges::any_of(buttons, std::identity{});
    };
    constexpr double kWheelPause = 0.5;
    constexpr std::uint64_t kMouse = 1ull << 40, kWheel = 1ull << 41;
    if (any(io.MouseClicked)) ++presses;
    if (any(io.MouseDown) || any(io.MouseReleased)) return kMouse + presses;
    if (io.MouseWheel != 0) last_wheel = ImGui::GetTime();
    if (ImGui::GetTime() - last_wheel < kWheelPause) return kWheel;
    return ImGui::GetActiveID();
}

void Application::Impl::draw_panels() {
    for (std::size_t i = 0; i < kPanels.size(); ++i) {
        bool open = !editor.panels.closed[i];
        if (!open) continue;
        if (ImGui::Begin(kPanels[i].name, &open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoFocusOnAppearing))
            kPanels[i].draw(editor);
        ImGui::End();
        editor.panels.closed[i] = !open;
    }
}

void Application::Impl::draw(bool present) {
    begin_imgui_frame();
    editor.begin_frame(held_gesture());
    draw_menu_bar(editor);
    if (editor.view.reset_layout) editor.panels.closed = {};
    draw_dockspace(editor.view.reset_layout);
    editor.view.reset_layout = false;
    viewport.draw(editor);
    draw_panels();
    render_imgui(*context, {0, 0, 0});
    if (present) context->present();
    update_title();
}

void Application::Impl::update_title() {
    GLFWwindow* const window = context->window();
    if (!window) return;
    std::string next = editor.title() + (editor.is_modified() ? " *" : "") + " - Rayuela";
    if (next == title) return;
    glfwSetWindowTitle(window, next.c_str());
    title = std::move(next);
}

void Application::Impl::drop(const std::filesystem::path& file) {
    refresh = true;
    if (ImGui::GetIO().KeyShift) return editor.import(file);
    editor.after_asking_to_save([file](Editor& target) { target.open(file); });
}

constexpr double kLongestSleep = 60;  ///< Seconds; then the editor may have something to autosave.

/// Sleeps until something may have to be drawn, then says whether it has to.
bool Application::Impl::wait_and_decide(FrameTiming& timing) {
    constexpr double kCheckLoads = 0.1;  ///< A finished load posts no event.
    timing.published = published;
    timing.animating =
        viewport.is_animating() || editor.health.is_busy() || editor.session().status().phase == SessionPhase::building;
    timing.now = now_seconds();
    const double longest = editor.is_loading() ? kCheckLoads : kLongestSleep;
    const double wait = std::min(seconds_to_next_frame(timing), longest);
    if (wait <= 0) {
        glfwPollEvents();
    } else {
        glfwWaitEventsTimeout(wait);
    }
    timing.now = now_seconds();
    if (refresh || !ImGui::GetCurrentContext()->InputEventsQueue.empty()) {
        timing.last_input = timing.now;
        timing.frames_since_input = 0;
    }
    refresh = false;
    timing.published = published;
    if (glfwWindowShouldClose(context->window())) {
        glfwSetWindowShouldClose(context->window(), GLFW_FALSE);
        editor.request_quit();
        timing.last_input = timing.now;
        timing.frames_since_input = 0;
    }
    return seconds_to_next_frame(timing) <= 0 || timing.now - timing.last_draw >= longest;
}

Application::Application(std::unique_ptr<GlContext> context, Preferences preferences, int threads)
    : impl_(std::make_unique<Impl>(std::move(context), std::move(preferences), threads)) {}

Application::~Application() = default;

void Application::drop(const std::filesystem::path& file) {
    impl_->drop(file);
}

Editor& Application::editor() {
    return impl_->editor;
}

void Application::draw_frame() {
    impl_->draw(true);
}

const Display::Statistics& Application::display_statistics() const {
    return impl_->viewport.display().statistics();
}

void Application::run() {
    GLFWwindow* const window = impl_->context->window();
    if (!window) return;
    FrameTiming timing;
    timing.frames_since_input = 0;
    while (!impl_->editor.wants_quit) {
        if (glfwGetWindowAttrib(window, GLFW_ICONIFIED)) {
            glfwWaitEventsTimeout(kLongestSleep);
            impl_->editor.begin_frame(0);
            impl_->refresh = true;
            if (glfwWindowShouldClose(window)) glfwRestoreWindow(window);
            continue;
        }
        if (!impl_->wait_and_decide(timing)) continue;
        impl_->published = false;
        const double start = now_seconds();
        impl_->draw(true);
        timing.last_draw = start;
        ++timing.frames_since_input;
        timing.draw_cost = now_seconds() - start;
        const std::shared_ptr<const Frame>& frame = impl_->editor.frame();
        timing.render_seconds = frame ? frame->statistics.render_seconds : 0;
    }
}

Image Application::screenshot(int spp) {
    // Fonts, docks and the size of the film settle in the first frames.
    constexpr int kSettlingFrames = 10;
    constexpr auto kPause = std::chrono::milliseconds(15);
    for (int frames = 0;; ++frames) {
        impl_->draw(false);
        const std::shared_ptr<const Frame>& frame = impl_->editor.frame();
        const bool current =
            frame && frame->scene && frame->scene->film == impl_->editor.shown().film && !frame->coarse;
        const bool done =
            current && (frame->statistics.spp >= spp || frame->statistics.phase == SessionPhase::finished);
        if (frames >= kSettlingFrames && !impl_->editor.is_loading() && !impl_->viewport.is_animating() &&
            !impl_->editor.health.is_busy() && done)
            break;
        std::this_thread::sleep_for(kPause);
    }
    return impl_->context->read_pixels();
}

}  // namespace rayuela
