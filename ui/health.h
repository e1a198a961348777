#pragma once

#include "core/render/frame.h"
#include "core/render/path_health.h"
#include "core/render/replay.h"
#include "ui/background.h"
#include "ui/view_settings.h"

namespace rayuela {

/// Numerical health of the frame on screen. Maps are worked out while they are looked at and counts of paths when asked
/// for, from the frame's own RenderScene on another thread: rendering goes on, and nothing waits.
class Health {
public:
    /// Once a frame of the user interface: takes what has been finished, starts what `wanted` needs, and forgets what is of
    /// another scene. `frame` may be null.
    void update(const std::shared_ptr<const Frame>& frame, ViewMap wanted);
    /// Something will be finished that no event announces.
    bool is_busy() const { return map_work_.is_busy() || measurement_.is_busy(); }

    /// The wanted map in colours, as a frame to be displayed without exposure and tone map; null where there is none yet,
    /// or the image itself is wanted.
    std::shared_ptr<const Frame> picture() const { return map_ ? map_->picture : nullptr; }
    /// The number behind a pixel of `picture`.
    std::optional<float> value(const glm::ivec2& pixel) const;

    /// Counts on the paths of the scene on screen, replacing what was counted before.
    void measure();
    bool is_measuring() const { return measurement_.is_busy(); }
    /// Null where nothing has been counted for the scene on screen.
    const PathHealth* measured() const { return measured_ ? &*measured_ : nullptr; }

    bool replays = false;           ///< Clicks in the image replay samples.
    glm::ivec2 replayed_pixel{-1};  ///< Of the film; negative: none chosen yet.
    int replayed_sample = 0;
    /// That sample of the scene on screen; null where none is asked for.
    const Replay* replayed() const { return replay_ ? &replay_->second : nullptr; }

private:
    using SharedScene = std::shared_ptr<const RenderScene>;
    /// What a map depends on.
    struct MapKey {
        ViewMap map = ViewMap::image;
        SharedScene scene;
        std::uint64_t restarts = 0, counted = 0;  ///< Of maps of what the film counts.

        bool operator==(const MapKey&) const = default;
    };
    struct Map {
        MapKey key;
        std::vector<float> values;  ///< Empty where it was cancelled.
        std::shared_ptr<const Frame> picture;
    };
    struct ReplayKey {
        SharedScene scene;
        PathId id;
    };

    void update_map(const std::shared_ptr<const Frame>& frame, ViewMap wanted);
    void update_replay();

    SharedScene scene_;  ///< On screen.
    std::optional<Map> map_;
    std::uint64_t pictures_ = 0;
    std::optional<PathHealth> measured_;
    SharedScene measured_scene_;
    std::optional<std::pair<ReplayKey, Replay>> replay_;
    MapKey worked_out_;  ///< By map_work_, now or last.
    Background<Map> map_work_;
    Background<PathHealth> measurement_;
};

}  // namespace rayuela
