#include "core/render/render_session.h"

#include "core/render/progressive_renderer.h"
#include "core/render/tree_completion.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace rayuela {

namespace {

/// A build that is expected to be shorter is not broken off for a newer scene, or a stream of edits would show nothing.
constexpr double kShortBuildSeconds = 0.1;
constexpr auto kWaitInterval = std::chrono::milliseconds(50);

/// What other threads have asked for and the render thread has not yet seen.
struct Mail {
    std::shared_ptr<const Scene> scene;
    bool restart = false;
    bool flush = false;  ///< Publish what is there, complete or not, and pause.
    std::optional<bool> paused;
    std::optional<int> threads;
    std::optional<SamplingOptions> sampling;
    std::optional<Shortcuts> shortcuts;
    std::optional<std::shared_ptr<const Accelerator>> trees;  ///< From a TreeCompletion.
};

/// A build under way, and for what.
struct Build {
    std::shared_ptr<const Scene> scene;
    BuildControl control;
    bool is_short = false;

    bool outdated_by(const Scene& next) const {
        const SceneChanges changes = diff(*scene, next);
        return changes.geometry || changes.accel;
    }
};

SessionPhase phase_of(const Pass& pass) {
    switch (pass.kind) {
        case Pass::Kind::paused:
            return SessionPhase::paused;
        case Pass::Kind::finished:
            return SessionPhase::finished;
        default:
            return SessionPhase::rendering;
    }
}

double progress(std::uint64_t done, std::uint64_t total) {
    return total ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total)) : 0;
}

}  // namespace

struct RenderSession::Impl {
    explicit Impl(const SessionOptions& options) : renderer(options.interactive, options.threads) {
        renderer.set_drafts(options.interactive && options.drafts);
        renderer.set_sampling(options.sampling);
        thread = std::thread([this] { run(); });
    }
    ~Impl();

    template <typename Write>
    void send(Write&& write);
    SessionStatus current_status() const;

    void run();
    bool receive(bool idle, Mail& received);
    void handle(Mail& received);
    void take(std::shared_ptr<const Scene> scene);
    void take_trees(const std::shared_ptr<const Accelerator>& trees);
    void review_drafts();
    void begin_completion();
    void end_completion();
    bool render_next();
    void publish(bool flush = false);
    void report(SessionPhase phase);
    void report_problem(const char* problem);

    // Shared with the callers and guarded by `mutex`, but for the atomics.
    mutable std::mutex mutex;
    std::condition_variable mail_arrived, changed;
    std::optional<Mail> mail;
    bool flushing = false;  ///< A flush is asked for and not yet done.
    SessionStatus status;
    RenderStatistics statistics;
    std::shared_ptr<const Frame> frame;
    std::shared_ptr<Build> build;
    /// While drafts are being replaced. Only the render thread changes it.
    std::unique_ptr<TreeCompletion> completion;
    std::function<void()> callback;
    /// There is mail: what can be taken up again later stops at the next chance.
    std::atomic<bool> interrupted{false};
    std::atomic<bool> quitting{false};  ///< So does everything else.
    std::atomic<std::uint64_t> paths_done{0}, paths_wanted{0};

    // The render thread's own.
    ProgressiveRenderer renderer;
    std::thread thread;
};

RenderSession::Impl::~Impl() {
    {
        const std::lock_guard lock(mutex);
        quitting = interrupted = true;
        if (build) build->control.cancelled = true;
    }
    mail_arrived.notify_all();
    thread.join();
    completion.reset();
}

/// Lets `write` add to the mail and wakes the render thread.
template <typename Write>
void RenderSession::Impl::send(Write&& write) {
    {
        const std::lock_guard lock(mutex);
        if (!mail) mail.emplace();
        write(*mail);
        interrupted = true;
    }
    mail_arrived.notify_all();
}

SessionStatus RenderSession::Impl::current_status() const {
    const std::lock_guard lock(mutex);
    SessionStatus result = status;
    if (build) {
        result.build_progress = progress(build->control.done, build->control.total);
    } else if (completion) {
        result.build_progress = completion->progress();
    }
    result.pass_progress = progress(paths_done, paths_wanted);
    return result;
}

void RenderSession::Impl::run() {
    Mail received;
    for (bool idle = true; receive(idle, received);) {
        try {
            handle(received);
            idle = !render_next();
        } catch (const std::exception& problem) {
            report_problem(problem.what());
            idle = true;
        }
    }
}

/// Fetches the mail, waiting for some if `idle`; false when it is time to quit.
bool RenderSession::Impl::receive(bool idle, Mail& received) {
    std::unique_lock lock(mutex);
    if (idle) mail_arrived.wait(lock, [&] { return mail || quitting; });
    if (quitting) return false;
    received = std::move(mail).value_or(Mail{});
    mail.reset();
    interrupted = false;
    if (received.scene) {
        status.taken = status.submitted;
        build = std::make_shared<Build>();
        build->scene = received.scene;
        build->is_short = renderer.has_scene() && renderer.build_seconds() < kShortBuildSeconds;
    }
    if (received.scene || received.restart) status.phase = SessionPhase::rendering;
    return true;
}

void RenderSession::Impl::handle(Mail& received) {
    if (received.trees) take_trees(*received.trees);
    if (received.threads) renderer.set_threads(*received.threads);
    if (received.sampling) renderer.set_sampling(*received.sampling);
    if (received.shortcuts) renderer.set_shortcuts(*received.shortcuts);
    if (received.paused) renderer.set_paused(*received.paused);
    const bool may_draft = received.scene || received.shortcuts;
    if (received.scene) take(std::move(received.scene));
    if (may_draft && renderer.has_scene()) review_drafts();
    if (received.restart && renderer.has_scene()) renderer.restart();
    if (received.flush) {
        renderer.set_paused(true);
        if (renderer.has_scene()) publish(true);
        const std::lock_guard lock(mutex);
        flushing = false;
    }
    if (received.flush) changed.notify_all();
}

void RenderSession::Impl::take(std::shared_ptr<const Scene> scene) {
    if (!renderer.has_scene() || build->outdated_by(renderer.scene())) report(SessionPhase::building);
    // Shown before a pass, which the next edit may break off.
    if (renderer.take(std::move(scene), build->control) && renderer.publication_due()) publish();
    const std::lock_guard lock(mutex);
    build.reset();
    status.problem.clear();
    status.build_progress = 0;
}

void RenderSession::Impl::take_trees(const std::shared_ptr<const Accelerator>& trees) {
    end_completion();
    if (trees) renderer.take_trees(*trees);
    renderer.set_drafted(trees && renderer.render_scene()->has_drafts());
}

/// After trees may have been built: drafts among them are to be replaced, by nothing that no longer suits them.
void RenderSession::Impl::review_drafts() {
    if (completion && !completion->suits(*renderer.render_scene())) end_completion();
    renderer.set_drafted(renderer.render_scene()->has_drafts());
}

void RenderSession::Impl::begin_completion() {
    if (!renderer.drafted() || completion) return;
    auto begun = std::make_unique<TreeCompletion>(
        renderer.render_scene(), renderer.threads(),
        [this](std::shared_ptr<const Accelerator> trees) { send([&](Mail& to) { to.trees = std::move(trees); }); });
    const std::lock_guard lock(mutex);
    completion = std::move(begun);
}

void RenderSession::Impl::end_completion() {
    std::unique_ptr<TreeCompletion> ended;
    {
        const std::lock_guard lock(mutex);
        std::swap(ended, completion);
    }
    ended.reset();  // Waits for its thread, which may be sending mail.
    const std::lock_guard lock(mutex);
    if (mail) mail->trees.reset();
}

/// Does the next pass and shows what is worth it; false where nothing is left to do.
bool RenderSession::Impl::render_next() {
    if (!renderer.has_scene()) return false;
    const Pass pass = renderer.next_pass();
    if (pass.kind != Pass::Kind::coarse) begin_completion();
    if (pass.kind == Pass::Kind::wait) {
        if (completion) report(SessionPhase::building);
        std::unique_lock lock(mutex);
        mail_arrived.wait_for(lock, std::chrono::duration<double>(pass.wait_seconds), [&] { return mail || quitting; });
        return true;
    }
    const bool short_anyway = pass.kind == Pass::Kind::coarse || pass.kind == Pass::Kind::brief;
    const bool resting = pass.kind == Pass::Kind::paused || pass.kind == Pass::Kind::finished;
    if (!resting) {
        report(SessionPhase::rendering);
        paths_done = 0;
        paths_wanted = renderer.paths_of(pass);
        renderer.render(pass, short_anyway ? quitting : interrupted, paths_done);
    }
    if ((!interrupted || short_anyway) && renderer.publication_due()) publish();
    if (resting) report(phase_of(pass));
    return !resting;
}

void RenderSession::Impl::publish(bool flush) {
    std::shared_ptr<const Frame> next = renderer.publish(phase_of(renderer.next_pass()), flush);
    std::function<void()> notify;
    {
        const std::lock_guard lock(mutex);
        std::swap(frame, next);  // The old one, if it dies, does so outside of the lock.
        statistics = frame->statistics;
        notify = callback;
    }
    if (notify) notify();
}

void RenderSession::Impl::report(SessionPhase phase) {
    const RenderStatistics now = renderer.has_scene() ? renderer.statistics(phase) : RenderStatistics{};
    {
        const std::lock_guard lock(mutex);
        statistics = now;
        status.phase = statistics.phase = phase;
    }
    changed.notify_all();
}

void RenderSession::Impl::report_problem(const char* problem) {
    {
        const std::lock_guard lock(mutex);
        status.phase = SessionPhase::idle;
        status.problem = problem;
        build.reset();
        flushing = false;
    }
    changed.notify_all();
}

RenderSession::RenderSession(const SessionOptions& options) : impl_(std::make_unique<Impl>(options)) {}

RenderSession::~RenderSession() = default;

void RenderSession::submit(std::shared_ptr<const Scene> scene) {
    std::shared_ptr<Build> build;
    impl_->send([&](Mail& mail) {
        mail.scene = scene;
        ++impl_->status.submitted;
        build = impl_->build;
    });
    if (build && !build->is_short && build->outdated_by(*scene)) build->control.cancelled = true;
}

void RenderSession::set_paused(bool paused) {
    impl_->send([&](Mail& mail) { mail.paused = paused; });
}

void RenderSession::set_threads(int threads) {
    impl_->send([&](Mail& mail) { mail.threads = threads; });
}

void RenderSession::set_sampling(const SamplingOptions& sampling) {
    impl_->send([&](Mail& mail) { mail.sampling = sampling; });
}

void RenderSession::set_shortcuts(const Shortcuts& shortcuts) {
    impl_->send([&](Mail& mail) { mail.shortcuts = shortcuts; });
}

void RenderSession::restart() {
    impl_->send([](Mail& mail) { mail.restart = true; });
}

std::shared_ptr<const Frame> RenderSession::frame() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->frame;
}

SessionStatus RenderSession::status() const {
    return impl_->current_status();
}

void RenderSession::on_publish(std::function<void()> callback) {
    const std::lock_guard lock(impl_->mutex);
    impl_->callback = std::move(callback);
}

std::shared_ptr<const Frame> RenderSession::wait(
    const std::function<bool(const SessionStatus&, const RenderStatistics&)>& interrupted) {
    const auto done = [&] {
        return !impl_->mail && (impl_->status.phase == SessionPhase::finished || !impl_->status.problem.empty());
    };
    std::unique_lock lock(impl_->mutex);
    while (!impl_->changed.wait_for(lock, kWaitInterval, done)) {
        const RenderStatistics statistics = impl_->statistics;
        lock.unlock();
        const bool stop = interrupted && interrupted(status(), statistics);
        if (stop) {
            impl_->send([&](Mail& mail) { impl_->flushing = mail.flush = true; });
        }
        lock.lock();
        if (stop) {
            impl_->changed.wait(lock, [&] { return !impl_->flushing; });
            break;
        }
    }
    return impl_->frame;
}

}  // namespace rayuela
