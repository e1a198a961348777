#pragma once

#include "core/math/image.h"
#include "core/math/result.h"

#include <functional>
#include <memory>
#include <string>

struct GLFWwindow;

namespace rayuela {

/// An OpenGL 3.3 core context, current on the calling thread, with its functions loaded. There are two makers, a window
/// and an off-screen buffer; everything above draws through either without knowing which.
class GlContext {
public:
    virtual ~GlContext() = default;

    /// Size to draw, pixels.
    virtual glm::ivec2 framebuffer_size() const = 0;
    /// Pixels a unit of the user interface: 1, or 1.5 to 3 on a dense display.
    virtual float scale() const = 0;
    /// The window behind the context; null off-screen.
    virtual GLFWwindow* window() const { return nullptr; }
    /// Shows what has been drawn (swaps buffers, or flushes).
    virtual void present() = 0;
    /// What has been drawn, 8-bit values in [0, 1] as displayed, first row at the top.
    Image read_pixels() const;
};

/// Opens a window; an error where there is no display or no OpenGL 3.3.
Result<std::unique_ptr<GlContext>> make_window_context(const std::string& title, glm::ivec2 size);
/// A buffer without a display, through OSMesa, or EGL where Mesa has no OSMesa any more.
Result<std::unique_ptr<GlContext>> make_offscreen_context(glm::ivec2 size, float scale = 1);

}  // namespace rayuela
