#pragma once

#include "core/render/frame.h"

#include <string>
#include <string_view>
#include <vector>

namespace rayuela {

class RenderScene;

enum class SkipState : std::uint8_t {
    skipped,   ///< Left out.
    put_back,  ///< Done on request, though the scene does not need it.
    needed,    ///< Done, because the scene needs it.
    absent,    ///< Nothing in the scene asks for it.
};

/// Work or memory that a renderer of any scene has to provide for, and that this one can do without.
struct Skip {
    std::string_view name;  ///< Of the work, as a heading.
    SkipState state = SkipState::absent;
    std::string why;  ///< Why it is left out, or what needs it; for a person.

    /// How much is left out, in `unit` ("bytes", "objects"...), where that is known; else 0.
    std::uint64_t saved = 0;
    std::string_view unit;

    /// How much of the work a render has done: 0 where it is left out. Null where nothing counts it.
    std::uint64_t (*counter)(const RenderStatistics&) = nullptr;
    std::string_view counted;  ///< What `counter` counts, in the plural.

    /// Puts the work back; null where it cannot be: without it the image or the scene would be another.
    const ShortcutField* shortcut = nullptr;
};

/// "skipped", "put back", "needed", "absent".
std::string_view name_of(SkipState state);

/// All that the renderer leaves out where it can, and whether it can here. Derived from what the kernels read.
std::vector<Skip> skips_of(const RenderScene& scene);
/// The same, and what the render behind a frame has left out or put back.
std::vector<Skip> skips_of(const Frame& frame);

}  // namespace rayuela
