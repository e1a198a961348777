#include "ui/gl_context.h"

#include <glad/glad.h>

#if RAYUELA_HAS_OSMESA
#define GLAPIENTRY APIENTRY
#include <GL/osmesa.h>
#include <dlfcn.h>
#endif
#if RAYUELA_HAS_EGL
#include <EGL/egl.h>
#include <EGL/eglext.h>
#endif

#include <optional>
#include <type_traits>
#include <vector>

namespace rayuela {

namespace {

#if RAYUELA_HAS_OSMESA
/// Loaded when it is needed and then kept: linked, it would make every start of the program 13 ms longer.
struct OsMesa {
    decltype(&OSMesaCreateContextAttribs) create = nullptr;
    decltype(&OSMesaDestroyContext) destroy = nullptr;
    decltype(&OSMesaMakeCurrent) make_current = nullptr;
    decltype(&OSMesaGetProcAddress) proc_address = nullptr;

    static std::optional<OsMesa> load() {
        void* library = nullptr;
        for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
            if (!library) library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
        }
        if (!library) return std::nullopt;
        OsMesa mesa;
        const auto find = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
            return function != nullptr;
        };
        const bool found = find(mesa.create, "OSMesaCreateContextAttribs") &&
                           find(mesa.destroy, "OSMesaDestroyContext") && find(mesa.make_current, "OSMesaMakeCurrent") &&
                           find(mesa.proc_address, "OSMesaGetProcAddress");
        return found ? std::optional(mesa) : std::nullopt;
    }
};

struct OsMesaDeleter {
    decltype(&OSMesaDestroyContext) destroy;
    void operator()(OSMesaContext context) const { destroy(context); }
};

/// Mesa's software rasteriser into our own memory: needs neither a display nor a device.
class OsMesaContext final : public GlContext {
public:
    OsMesaContext(const OsMesa& mesa, OSMesaContext context, glm::ivec2 size, float scale)
        : mesa_(mesa),
          context_(context, {mesa.destroy}),
          size_(size),
          scale_(scale),
          pixels_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

    bool make_current() {
        return mesa_.make_current(context_.get(), pixels_.data(), GL_UNSIGNED_BYTE, size_.x, size_.y) == GL_TRUE &&
               gladLoadGLLoader(reinterpret_cast<GLADloadproc>(mesa_.proc_address)) && GLAD_GL_VERSION_3_3;
    }
    glm::ivec2 framebuffer_size() const override { return size_; }
    float scale() const override { return scale_; }
    void present() override { glFinish(); }

private:
    OsMesa mesa_;
    std::unique_ptr<osmesa_context, OsMesaDeleter> context_;
    glm::ivec2 size_;
    float scale_;
    std::vector<glm::u8vec4> pixels_;
};

std::unique_ptr<GlContext> make_osmesa_context(glm::ivec2 size, float scale) {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              24,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    const std::optional<OsMesa> mesa = OsMesa::load();
    const OSMesaContext handle = mesa ? mesa->create(attributes, nullptr) : nullptr;
    if (!handle) return nullptr;
    auto context = std::make_unique<OsMesaContext>(*mesa, handle, size, scale);
    return context->make_current() ? std::move(context) : nullptr;
}
#endif

#if RAYUELA_HAS_EGL
/// EGL without a window system, drawing into a framebuffer object that stays bound.
class EglContext final : public GlContext {
public:
    EglContext(glm::ivec2 size, float scale) : size_(size), scale_(scale) {}
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    ~EglContext() override {
        if (framebuffer_) glDeleteFramebuffers(1, &framebuffer_);
        if (color_) glDeleteRenderbuffers(1, &color_);
        if (context_ != EGL_NO_CONTEXT) {
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            eglDestroyContext(display_, context_);
        }
        if (display_ != EGL_NO_DISPLAY) eglTerminate(display_);
    }

    bool make_current() {
        const auto get_display =
            reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
        if (!get_display) return false;
        display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) return false;
        if (!eglBindAPI(EGL_OPENGL_API)) return false;
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
        EGLConfig config{};
        EGLint count = 0;
        if (!eglChooseConfig(display_, wanted, &config, 1, &count)) return false;
        if (count == 0) config = EGL_NO_CONFIG_KHR;
        const EGLint attributes[] = {
            EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes);
        if (context_ == EGL_NO_CONTEXT) return false;
        if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return false;
        if (!gladLoadGLLoader(reinterpret_cast<GLADloadproc>(eglGetProcAddress)) || !GLAD_GL_VERSION_3_3) return false;
        return bind_framebuffer();
    }
    glm::ivec2 framebuffer_size() const override { return size_; }
    float scale() const override { return scale_; }
    void present() override { glFinish(); }

private:
    bool bind_framebuffer() {
        glGenRenderbuffers(1, &color_);
        glBindRenderbuffer(GL_RENDERBUFFER, color_);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size_.x, size_.y);
        glGenFramebuffers(1, &framebuffer_);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
        return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    }

    glm::ivec2 size_;
    float scale_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    unsigned framebuffer_ = 0, color_ = 0;
};

std::unique_ptr<GlContext> make_egl_context(glm::ivec2 size, float scale) {
    auto context = std::make_unique<EglContext>(size, scale);
    return context->make_current() ? std::move(context) : nullptr;
}
#endif

}  // namespace

Result<std::unique_ptr<GlContext>> make_offscreen_context(glm::ivec2 size, float scale) {
    if (size.x < 1 || size.y < 1) return fail("", "off-screen window", "the size must be positive");
#if RAYUELA_HAS_OSMESA
    if (auto context = make_osmesa_context(size, scale)) return context;
#endif
#if RAYUELA_HAS_EGL
    if (auto context = make_egl_context(size, scale)) return context;
#endif
    return fail("", "off-screen window", "neither OSMesa nor EGL gives an OpenGL 3.3 core context");
}

}  // namespace rayuela
