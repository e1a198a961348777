#include "ui/imgui_session.h"

#include "ui/theme.h"

#include <glad/glad.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
#include <implot.h>

namespace rayuela {

ImGuiSession::ImGuiSession(const GlContext& context, const std::filesystem::path& folder) : window_(context.window()) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImPlot::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.ConfigFlags |= ImGuiConfigFlags_DockingEnable | ImGuiConfigFlags_NavEnableKeyboard;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    io.ConfigDockingTransparentPayload = true;
    io.ConfigErrorRecoveryEnableAssert = false;
    if (!folder.empty()) layout_file_ = (folder / "layout.ini").string();
    io.IniFilename = layout_file_.empty() ? nullptr : layout_file_.c_str();
    load_fonts();
    if (window_) ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

ImGuiSession::~ImGuiSession() {
    ImGui_ImplOpenGL3_Shutdown();
    if (window_) ImGui_ImplGlfw_Shutdown();
    ImPlot::DestroyContext();
    ImGui::DestroyContext();
}

void render_imgui(const GlContext& context, const Vec3& background) {
    ImGui::Render();
    const glm::ivec2 size = context.framebuffer_size();
    glViewport(0, 0, size.x, size.y);
    glDisable(GL_SCISSOR_TEST);
    glClearColor(background.r, background.g, background.b, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace rayuela
