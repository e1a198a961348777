#pragma once

#include "core/io/asset_cache.h"
#include "core/render/render_session.h"
#include "core/scene/history.h"
#include "core/scene/scene_edit.h"
#include "ui/convergence.h"
#include "ui/file_dialog.h"
#include "ui/health.h"
#include "ui/log.h"
#include "ui/panels/panel_state.h"
#include "ui/preferences.h"
#include "ui/view_settings.h"

#include <filesystem>
#include <functional>
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
    Editor(const Editor&) = delete;
    Editor& operator=(const Editor&) = delete;

    const Scene& scene() const { return *history_.current(); }
    /// The same, to be held while edits replace it.
    std::shared_ptr<const Scene> snapshot() const { return history_.current(); }
    /// What is being rendered: `scene()`, its film sized by the viewport where view.match_window asks for it.
    const Scene& shown() const { return *shown_; }
    RenderSession& session() { return session_; }
    /// The frame on screen, taken once by `begin_frame`; null before the first.
    const std::shared_ptr<const Frame>& frame() const { return frame_; }
    /// How the estimated error has fallen since accumulation last restarted.
    const ConvergenceHistory& convergence() const { return convergence_; }

    /// Once a user-interface frame: takes the newest frame, finishes loads, tells the session of `paused`, `threads` and `sampling`.
    /// `gesture` is the identity of what the mouse or keyboard is holding (an ImGui id), 0 when nothing is: edits of one
    /// gesture are one step of undo.
    void begin_frame(std::uint64_t gesture);

    /// Applies, submits and remembers for undo. A refused edit leaves the scene as it is and says why in the log.
    bool edit(const SceneEdit& edit, std::string label);
    void undo();
    void redo();
    bool can_undo() const { return history_.can_undo(); }
    bool can_redo() const { return history_.can_redo(); }
    std::string undo_label() const { return history_.undo_label(); }
    std::string redo_label() const { return history_.redo_label(); }

    /// The size of the viewport in pixels, which the film takes while view.match_window holds. Part of no history and of
    /// no file.
    void resize_film(int width, int height);

    /// An empty scene under a sky.
    void new_scene();
    /// Loads in the background; on failure the scene stays and the log says why.
    void open(const std::filesystem::path& file);
    /// Adds the objects of a mesh or glTF file to the scene (background, one step of undo).
    void import(const std::filesystem::path& file);
    /// Reads the file in the background and puts it in place of the object's mesh or glTF file.
    void load_object_data(ObjectId id, const std::filesystem::path& file);
    /// Reads an image in the background and multiplies the field `key` of the material with it.
    void load_texture(MaterialId id, const std::string& key, const std::filesystem::path& file);
    /// Reads a panorama in the background and surrounds the scene with it.
    void load_environment(const std::filesystem::path& file);
    /// True while a file is being loaded.
    bool is_loading() const { return !loads_.empty(); }
    /// What is being loaded, for a person; empty when nothing is.
    std::string loading_label() const;

    bool save();                                         ///< To `file()`; false where there is none or it fails.
    bool save_as(const std::filesystem::path& file);     ///< To a .scene.json.
    bool save_image(const std::filesystem::path& file);  ///< PNG as displayed, EXR, HDR and PFM linear.
    const std::filesystem::path& file() const { return file_; }
    /// File name of the scene, or "Untitled".
    std::string title() const;
    /// Differs from what was last opened or saved.
    bool is_modified() const;

    /// Writes unsaved changes to the configuration folder; begin_frame does it once a minute.
    void autosave();
    /// What a session that ended without saving, by a crash or a kill, had autosaved; empty where there is nothing.
    std::filesystem::path lost_work() const;
    /// Opens that, as an unsaved scene, once unsaved changes of this one are dealt with.
    void restore_lost_work();

    /// Does it at once, or, where there are unsaved changes, after having asked (see draw_menu_bar).
    void after_asking_to_save(std::function<void(Editor&)> action);
    /// For the window's close button: sets `wants_quit` once nothing unsaved would be lost.
    void request_quit();

    std::optional<ObjectId> selection;
    std::optional<MaterialId> selected_material;  ///< In the material list, while no object is selected.
    ViewSettings view;
    Preferences preferences;
    PanelState panels;
    Health health;
    FileDialog file_dialog;
    Log log;
    bool paused = false;
    int threads = 0;
    SamplingSettings sampling;
    Shortcuts shortcuts;  ///< Of this run of the program: all are taken again at the next.
    bool wants_quit = false;
    std::function<void(Editor&)> unsaved_action;  ///< What waits for the answer to "save changes?".

private:
    struct Load;
    struct Loaded;
    void load(std::string label, std::filesystem::path opened, std::function<Result<Loaded>()> read);
    void finish(Load& load);
    void push(std::shared_ptr<const Scene> scene, std::string label, std::uint64_t gesture);
    void show();
    void forget_lost_selection();
    void discard_autosave();

    SceneHistory history_;
    std::shared_ptr<const Scene> saved_;
    std::shared_ptr<const Scene> shown_;
    std::optional<glm::ivec2> film_size_;
    std::filesystem::path file_;
    std::uint64_t held_ = 0;     ///< What begin_frame was told last.
    std::uint64_t gesture_ = 0;  ///< Its number in the history: the same thing held again is a new gesture.
    std::uint64_t gestures_ = 0;
    std::shared_ptr<const Frame> frame_;
    ConvergenceHistory convergence_;
    std::shared_ptr<AssetCache> cache_;
    std::vector<std::unique_ptr<Load>> loads_;
    std::shared_ptr<const Scene> autosaved_;
    std::chrono::steady_clock::time_point autosave_time_;
    RenderSession session_;
    bool session_paused_ = false;
    int session_threads_ = 0;
    SamplingOptions session_sampling_;
    Shortcuts session_shortcuts_;
};

}  // namespace rayuela
