#pragma once

#include "core/math/id.h"
#include "core/math/vec.h"

#include <array>
#include <set>
#include <string>

namespace rayuela {

/// What the panels and dialogs remember from one frame to the next, besides what ImGui keeps itself.
struct PanelState {
    std::array<bool, 16> closed{};  ///< By index in kPanels.

    bool show_shortcuts = false;
    bool show_quick_start = false;
    bool show_about = false;
    bool show_lost_work = false;  ///< The question whether to restore it.

    std::string scene_filter;
    std::set<ObjectId> collapsed;  ///< Lists that are folded.
    ObjectId renaming;
    bool rename_started = false;  ///< The text field of `renaming` has had the keyboard.
    std::string new_name;

    /// Rotation as it is being edited: many angles make one quaternion, and the typed ones should stay.
    struct {
        glm::quat rotation{1, 0, 0, 0};
        Vec3 degrees{0};
    } euler;

    std::string log_filter;
    std::array<bool, 3> log_levels{true, true, true};
    std::size_t log_seen = 0;  ///< Entries when the log was last drawn.
    bool plot_over_time = false;

    void begin_rename(ObjectId id, const std::string& name) {
        renaming = id;
        rename_started = false;
        new_name = name;
    }
};

}  // namespace rayuela
