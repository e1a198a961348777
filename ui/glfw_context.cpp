#include "ui/gl_context.h"

// glad first: it takes the place of the system's OpenGL header.
#include <glad/glad.h>

#include <GLFW/glfw3.h>

namespace rayuela {

namespace {

/// GLFW from its start to its end.
struct GlfwLibrary {
    bool ready = glfwInit() == GLFW_TRUE;
    GlfwLibrary() = default;
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;
    ~GlfwLibrary() {
        if (ready) glfwTerminate();
    }
};

struct WindowDeleter {
    void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};

class WindowContext final : public GlContext {
public:
    WindowContext(std::unique_ptr<GlfwLibrary> library, GLFWwindow* window)
        : library_(std::move(library)), window_(window) {}

    glm::ivec2 framebuffer_size() const override {
        glm::ivec2 size(0);
        glfwGetFramebufferSize(window_.get(), &size.x, &size.y);
        return size;
    }
    float scale() const override {
        float x = 1, y = 1;
        glfwGetWindowContentScale(window_.get(), &x, &y);
        return x > 0 ? x : 1;
    }
    GLFWwindow* window() const override { return window_.get(); }
    void present() override { glfwSwapBuffers(window_.get()); }

private:
    std::unique_ptr<GlfwLibrary> library_;
    std::unique_ptr<GLFWwindow, WindowDeleter> window_;
};

std::string last_error(const std::string& otherwise) {
    const char* description = nullptr;
    glfwGetError(&description);
    return description ? description : otherwise;
}

/// The size asked for, or what the screen has room for.
glm::ivec2 fitting_size(glm::ivec2 size) {
    GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
    if (!monitor) return size;
    glm::ivec2 position(0), room(0);
    glfwGetMonitorWorkarea(monitor, &position.x, &position.y, &room.x, &room.y);
    return room.x > 0 && room.y > 0 ? glm::min(size, room) : size;
}

}  // namespace

Result<std::unique_ptr<GlContext>> make_window_context(const std::string& title, glm::ivec2 size) {
    auto library = std::make_unique<GlfwLibrary>();
    if (!library->ready) return fail("", "window", last_error("no display"));
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "rayuela");
    size = fitting_size(size);
    GLFWwindow* const window = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
    if (!window) return fail("", "window", last_error("no window with OpenGL 3.3"));
    auto context = std::make_unique<WindowContext>(std::move(library), window);
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    if (!gladLoadGLLoader(reinterpret_cast<GLADloadproc>(glfwGetProcAddress)) || !GLAD_GL_VERSION_3_3) {
        return fail("", "window", "OpenGL 3.3 is needed");
    }
    return context;
}

}  // namespace rayuela
