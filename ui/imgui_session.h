#pragma once

#include "ui/gl_context.h"

#include <filesystem>

namespace rayuela {

/// ImGui, ImPlot and their backends for one GlContext, with the program's fonts.
class ImGuiSession {
public:
    /// Keeps the layout of the windows in `folder`, unless that is empty.
    ImGuiSession(const GlContext& context, const std::filesystem::path& folder);
    ImGuiSession(const ImGuiSession&) = delete;
    ImGuiSession& operator=(const ImGuiSession&) = delete;
    ~ImGuiSession();

private:
    GLFWwindow* window_;
    std::string layout_file_;
};

/// Draws what ImGui has for this frame over one colour.
void render_imgui(const GlContext& context, const Vec3& background);

}  // namespace rayuela
