#pragma once

#include "core/render/render_session.h"
#include "core/scene/history.h"
#include "core/scene/scene_edit.h"
#include "ui/log.h"
#include "ui/preferences.h"
#include "ui/view_settings.h"

#include <filesystem>
#include <optional>
#include <string>

namespace rayuela {

/// What panels, viewport and commands share: the scene and its history, the session that renders it, and what the person
/// has selected. Panels read `scene()` and change it only through `edit`; nothing here waits for the renderer.
class Editor {
public:
    /// `threads` 0: one a hardware thread.
    explicit Editor(Preferences preferences, int threads = 0);
    ~Editor();

    const Scene& scene() const { return *history_.current(); }
    RenderSession& session() { return session_; }
    /// The frame on screen, taken once by `begin_frame`; null before the first.
    const std::shared_ptr<const Frame>& frame() const { return frame_; }

    /// Once a user-interface frame: takes the newest frame, finishes loads. `gesture` is the identity of what the mouse
    /// or keyboard is holding (an ImGui id), 0 when nothing is: edits of one gesture are one step of undo.
    void begin_frame(std::uint64_t gesture);

    /// Applies, submits and remembers for undo. A refused edit leaves the scene as it is and says why in the log.
    bool edit(const SceneEdit& edit, std::string label);
    void undo();
    void redo();
    bool can_undo() const { return history_.can_undo(); }
    bool can_redo() const { return history_.can_redo(); }
    std::string undo_label() const { return history_.undo_label(); }
    std::string redo_label() const { return history_.redo_label(); }

    /// Loads in the background; on failure the scene stays and the log says why.
    void open(const std::filesystem::path& file);
    /// Adds the objects of a mesh or glTF file to the scene (background, one step of undo).
    void import(const std::filesystem::path& file);
    /// True while a file is being loaded.
    bool is_loading() const;
    bool save();                                          ///< To `file()`; false where there is none or it fails.
    bool save_as(const std::filesystem::path& file);
    bool save_image(const std::filesystem::path& file);   ///< PNG as displayed, EXR and PFM linear.
    const std::filesystem::path& file() const { return file_; }
    /// Differs from what was last opened or saved.
    bool is_modified() const;

    std::optional<ObjectId> selection;
    std::optional<MaterialId> selected_material;
    ViewSettings view;
    Preferences preferences;
    Log log;
    bool paused = false;
    int threads = 0;
    bool wants_quit = false;

private:
    struct Load;
    void show(std::shared_ptr<const Scene> scene);

    SceneHistory history_;
    std::shared_ptr<const Scene> saved_;
    std::filesystem::path file_;
    std::uint64_t gesture_ = 0;
    std::shared_ptr<const Frame> frame_;
    std::unique_ptr<Load> load_;
    RenderSession session_;
};

}  // namespace rayuela
