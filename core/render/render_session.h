#pragma once

#include "core/render/frame.h"
#include "core/render/sampling_options.h"

#include <functional>
#include <memory>
#include <string>

namespace rayuela {

struct SessionOptions {
    int threads = 0;          ///< Workers; 0 is one a hardware thread.
    bool interactive = true;  ///< Coarse passes after a restart, and frames published while rendering.
    bool drafts = true;       ///< Interactive: a large mesh is first shown in the draft of a tree (kDraftTriangles).
    SamplingOptions sampling;
};

/// Progress that changes between frames.
struct SessionStatus {
    SessionPhase phase = SessionPhase::idle;
    double build_progress = 0;    ///< In [0, 1] while building.
    double pass_progress = 0;     ///< In [0, 1] within the current pass.
    std::uint64_t submitted = 0;  ///< Scenes submitted so far.
    std::uint64_t taken = 0;      ///< The last of them that the render thread has begun with.
    std::string problem;          ///< Why the newest scene could not be rendered (out of memory); else empty.
};

/// Renders the latest submitted scene on its own threads, pass after pass. No call waits for the renderer, except
/// `wait` and the destructor; all may come from any thread.
class RenderSession {
public:
    explicit RenderSession(const SessionOptions& options = {});
    ~RenderSession();
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;

    /// The latest wins. What differs from the scene before decides what is rebuilt and whether accumulation restarts.
    void submit(std::shared_ptr<const Scene> scene);
    void set_paused(bool paused);
    void set_threads(int threads);
    /// A new target error goes on with the samples that are there; another clamp restarts.
    void set_sampling(const SamplingOptions& sampling);
    /// Puts work back that the scene does not need, or leaves it out again, and restarts: the image will be the same.
    void set_shortcuts(const Shortcuts& shortcuts);
    /// Throws the accumulated samples away and starts anew.
    void restart();

    /// The newest frame; null before the first.
    std::shared_ptr<const Frame> frame() const;
    SessionStatus status() const;
    /// Called on the render thread after each publication, to wake a sleeping window. Must return at once.
    void on_publish(std::function<void()> callback);

    /// Headless: blocks until the scene's limit or the target error is reached, or `interrupted` (asked about 20 times a second, with the
    /// current status and statistics) returns true; then publishes and returns the frame of what is there.
    std::shared_ptr<const Frame> wait(
        const std::function<bool(const SessionStatus&, const RenderStatistics&)>& interrupted);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rayuela
