#pragma once

#include "core/render/accumulation.h"
#include "core/render/frame.h"
#include "core/render/render_scene.h"
#include "core/render/schedule.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <memory>

namespace rayuela {

/// Renders one scene pass by pass and follows its edits: all of a RenderSession but its thread. Not thread-safe; uses a
/// task arena of its own inside.
class ProgressiveRenderer {
public:
    ProgressiveRenderer(bool interactive, int threads, const PathTracerOptions& options = {});

    /// Whether drafts of trees will do at first; else, and by default, `take` builds those the scene asks for.
    void set_drafts(bool drafts) { drafts_ = drafts; }

    /// Makes `scene` the one to render; rebuilds what differs from the one before and restarts accumulation where the
    /// image changes. False, and nothing happens, when the build was cancelled.
    bool take(std::shared_ptr<const Scene> scene, BuildControl& control);
    void set_threads(int threads);
    void set_paused(bool paused) { paused_ = paused; }
    void set_sampling(const SamplingOptions& sampling);
    /// Rebuilds the tree over the objects where that is put back or left out again, and restarts.
    void set_shortcuts(const Shortcuts& shortcuts);
    /// Throws all samples away.
    void restart();

    /// Replaces drafts by the trees of `known`, and goes on with the image as it is.
    void take_trees(const Accelerator& known);
    /// Somebody builds trees in place of the drafts: nothing is done meanwhile but previews.
    void set_drafted(bool drafted) { drafted_ = drafted; }
    bool drafted() const { return drafted_; }

    bool has_scene() const { return render_scene_ != nullptr; }
    const std::shared_ptr<const RenderScene>& render_scene() const { return render_scene_; }
    int threads() const { return threads_; }
    const Scene& scene() const { return render_scene_->scene(); }
    /// Wall time of the last update that built trees.
    double build_seconds() const { return build_seconds_; }

    /// The following need a scene.
    Pass next_pass() const { return rayuela::next_pass(schedule_state()); }
    /// How many paths `pass` has, if it renders.
    std::uint64_t paths_of(const Pass& pass) const;
    /// Does `pass`, or as much of it as `cancelled` allows.
    void render(const Pass& pass, const std::atomic<bool>& cancelled, std::atomic<std::uint64_t>& paths_done);
    /// Whether there is a new image worth showing.
    bool publication_due() const;
    /// The newest image, with statistics as of now: the film, or the preview while the film has pixels without samples. `flush`: the film as it is.
    std::shared_ptr<const Frame> publish(SessionPhase phase, bool flush = false);
    /// The estimated error and the clamp's loss in it are those of the last publication.
    RenderStatistics statistics(SessionPhase phase) const;

private:
    using Clock = std::chrono::steady_clock;

    std::shared_ptr<const RenderScene> updated(std::shared_ptr<const Scene> scene, const SceneChanges& changes,
                                               BuildControl& control);
    void measure_memory() { memory_bytes_ = render_scene_->memory_bytes() + film_->film().memory_bytes(); }
    ScheduleState schedule_state() const;
    glm::ivec2 size_of(const Pass& pass) const;
    bool film_complete() const { return film_->samples() > 0; }
    bool goes_on(const SceneChanges& changes, const RenderScene& next);

    const bool interactive_;
    PathTracerOptions options_;
    SamplingOptions sampling_;
    bool paused_ = false, drafts_ = false, drafted_ = false;
    int threads_ = 0;
    tbb::task_arena arena_;
    std::unique_ptr<tbb::global_control> oversubscription_;  ///< Where more threads are asked for than TBB has.

    std::shared_ptr<const RenderScene> render_scene_;
    double build_seconds_ = 0;
    std::uint64_t memory_bytes_ = 0;
    Clock::time_point taken_at_{};

    std::unique_ptr<Accumulation> film_, preview_;
    bool preview_unpublished_ = false, film_unpublished_ = false, film_shown_ = false;
    bool relit_unpublished_ = false;  ///< The frame shows other light than the film.
    Clock::time_point relit_at_{};
    bool preview_done_ = false;
    RayCounts counts_;
    double render_seconds_ = 0, estimated_error_ = 0;
    ClampLoss clamp_loss_;
    double seconds_per_path_ = 0, publish_seconds_ = 0;
    Clock::time_point published_at_{};
    std::uint64_t version_ = 0, restarts_ = 0, relit_ = 0;
};

}  // namespace rayuela
