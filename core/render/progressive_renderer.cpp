#include "core/render/progressive_renderer.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace rayuela {

namespace {

using Clock = std::chrono::steady_clock;

/// A pass cut shorter than this says nothing about speed.
constexpr std::uint64_t kMeasurablePaths = 1000;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Clock::duration to_duration(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

bool has_size(const Accumulation* accumulation, const glm::ivec2& size) {
    return accumulation && accumulation->film().width() == size.x && accumulation->film().height() == size.y;
}

int hardware_threads() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

ProgressiveRenderer::ProgressiveRenderer(bool interactive, int threads, const PathTracerOptions& options)
    : interactive_(interactive), options_(options) {
    set_threads(threads);
}

void ProgressiveRenderer::set_threads(int threads) {
    const int wanted = threads > 0 ? threads : hardware_threads();
    if (wanted == threads_) return;
    threads_ = wanted;
    oversubscription_.reset();
    if (wanted > hardware_threads()) {
        oversubscription_ = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                                  static_cast<std::size_t>(wanted));
    }
    arena_.terminate();
    arena_.initialize(wanted);
}

void ProgressiveRenderer::set_sampling(const SamplingOptions& sampling) {
    const SamplingOptions before = std::exchange(sampling_, sampling);
    if (!film_ || before == sampling) return;
    film_->set_options(sampling);
    if (before.clamp != sampling.clamp) {
        restart();
    } else {
        film_unpublished_ = film_shown_;  // The numbers beside the image have changed.
    }
}

void ProgressiveRenderer::set_shortcuts(const Shortcuts& shortcuts) {
    const Shortcuts before = std::exchange(options_.shortcuts, shortcuts);
    if (!render_scene_ || before == shortcuts) return;
    if (before.few_objects != shortcuts.few_objects) {
        BuildControl control;
        render_scene_ = updated(render_scene_->shared_scene(), {.accel = true}, control);
    }
    restart();
}

std::shared_ptr<const RenderScene> ProgressiveRenderer::updated(std::shared_ptr<const Scene> scene,
                                                                const SceneChanges& changes, BuildControl& control) {
    return arena_.execute([&] {
        return RenderScene::update(render_scene_.get(), std::move(scene), changes, control, options_.shortcuts,
                                   drafts_);
    });
}

bool ProgressiveRenderer::take(std::shared_ptr<const Scene> scene, BuildControl& control) {
    const SceneChanges changes = render_scene_ ? diff(render_scene_->scene(), *scene) : all_changes();
    const auto start = Clock::now();
    auto next = updated(std::move(scene), changes, control);
    if (!next) return false;
    const glm::ivec2 size(next->scene().film.width, next->scene().film.height);
    if (!has_size(film_.get(), size)) {
        film_ = std::make_unique<Accumulation>(size.x, size.y);
        film_->set_options(sampling_);
    }
    const bool restarts = !goes_on(changes, *next);
    render_scene_ = std::move(next);
    measure_memory();
    if (changes.geometry || changes.accel) build_seconds_ = seconds_since(start);
    if (restarts) {
        restart();
    } else {
        film_unpublished_ |= film_shown_;  // The samples stay, but what is said beside the image has changed.
    }
    return true;
}

/// Whether the film can be gone on with, for which it is scaled where light has changed.
bool ProgressiveRenderer::goes_on(const SceneChanges& changes, const RenderScene& next) {
    if (changes.restarts()) return false;
    if (changes.light.value_or(Vec3d(1)) == Vec3d(1)) return true;
    if (!LightTracer::shares_alike(*render_scene_, next)) return false;
    if (!arena_.execute([&] { return film_->scale_light(*changes.light); })) return false;
    ++relit_;
    relit_unpublished_ = true;
    relit_at_ = Clock::now();
    return true;
}

void ProgressiveRenderer::take_trees(const Accelerator& known) {
    render_scene_ = arena_.execute([&] { return render_scene_->with_trees(known); });
    measure_memory();
    build_seconds_ += known.stats().build_seconds;
    film_unpublished_ |= film_shown_;
}

void ProgressiveRenderer::restart() {
    film_->restart();
    if (preview_) preview_->restart();
    preview_unpublished_ = film_unpublished_ = film_shown_ = relit_unpublished_ = false;
    preview_done_ = false;
    counts_ = {};
    render_seconds_ = estimated_error_ = 0;
    clamp_loss_ = {};
    taken_at_ = Clock::now();
    relit_ = 0;
    ++restarts_;
}

ScheduleState ProgressiveRenderer::schedule_state() const {
    const RenderSettings& settings = scene().render;
    return {.width = film_->film().width(),
            .height = film_->film().height(),
            .interactive = interactive_,
            .paused = paused_,
            .drafted = drafted_,
            .max_samples = settings.max_samples,
            .max_seconds = settings.max_seconds,
            .samples = film_->samples(),
            .unfinished = film_->unfinished(),
            .preview_done = preview_done_,
            .render_seconds = render_seconds_,
            .quiet_seconds = seconds_since(taken_at_),
            .seconds_per_path = seconds_per_path_,
            .publish_seconds = publish_seconds_,
            .since_publication = seconds_since(published_at_),
            .unpublished = film_unpublished_,
            .film_shown = film_shown_,
            .since_relit = seconds_since(relit_at_)};
}

std::uint64_t ProgressiveRenderer::paths_of(const Pass& pass) const {
    const glm::ivec2 size = size_of(pass);
    if (pass.kind != Pass::Kind::coarse) return film_->paths_to(pass.samples);
    return static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
}

glm::ivec2 ProgressiveRenderer::size_of(const Pass& pass) const {
    return glm::max(glm::ivec2(1), glm::ivec2(film_->film().width(), film_->film().height()) / pass.divisor);
}

void ProgressiveRenderer::render(const Pass& pass, const std::atomic<bool>& cancelled,
                                 std::atomic<std::uint64_t>& paths_done) {
    const bool coarse = pass.kind == Pass::Kind::coarse;
    const glm::ivec2 size = size_of(pass);
    if (coarse && !has_size(preview_.get(), size)) preview_ = std::make_unique<Accumulation>(size.x, size.y);
    Accumulation& target = coarse ? *preview_ : *film_;
    const int samples = coarse ? target.samples() + 1 : pass.samples;
    const auto start = Clock::now();
    PassControl control{.cancelled = cancelled, .paths_done = paths_done};
    if (pass.stop_at > 0) control.stop_at = start + to_duration(pass.stop_at - render_seconds_);
    PathTracerOptions options = options_;
    if (coarse) options.light_tracing = false;  // a preview has no time for it
    const PathTracer tracer(*render_scene_, size.x, size.y, options);
    const RayCounts traced = arena_.execute([&] { return target.add_samples(tracer, samples, control); });

    const double seconds = seconds_since(start);
    render_seconds_ += seconds;
    counts_ += traced;
    // A brief pass may hold more of a round of lamp paths than goes with its camera paths.
    if (pass.kind != Pass::Kind::brief && traced.paths >= kMeasurablePaths)
        seconds_per_path_ = seconds / static_cast<double>(traced.paths);
    if (!coarse) {
        film_unpublished_ |= traced.paths > 0;
    } else if (target.samples() == samples) {
        preview_unpublished_ = true;
        preview_done_ = true;
    }
}

bool ProgressiveRenderer::publication_due() const {
    if (!film_complete()) return preview_unpublished_;
    return (interactive_ && relit_unpublished_) || publish_now(schedule_state());
}

std::shared_ptr<const Frame> ProgressiveRenderer::publish(SessionPhase phase, bool flush) {
    const auto start = Clock::now();
    const bool coarse = !film_complete() && preview_unpublished_ && !flush;
    if (!film_complete() && !coarse) film_->clear_unstarted();
    const Accumulation& source = coarse ? *preview_ : *film_;
    auto frame = std::make_shared<Frame>();
    frame->version = ++version_;
    frame->coarse = coarse;
    frame->object_ids = source.object_ids();
    frame->render_scene = render_scene_;
    frame->scene = render_scene_->shared_scene();
    arena_.execute([&] {
        frame->image = source.film().image();
        estimated_error_ = coarse ? 0 : source.film().relative_error();
        clamp_loss_ = coarse ? ClampLoss{} : source.clamp_loss();
    });
    frame->statistics = statistics(phase);
    const bool complete_samples =
        std::ranges::all_of(frame->statistics.rejected, [](auto count) { return count == 0; });
    if (!coarse) frame->sampled_blocks = source.sampled_blocks();
    if (!coarse && !complete_samples) frame->rejected_pixels = source.rejected_pixels();
    if (!coarse) {
        film_shown_ = true;
        film_unpublished_ = relit_unpublished_ = false;
        publish_seconds_ = seconds_since(start);
    }
    if (phase == SessionPhase::finished) preview_.reset();  // The next edit makes it anew: 1 to 12 MB until then.
    preview_unpublished_ = false;
    published_at_ = Clock::now();
    return frame;
}

RenderStatistics ProgressiveRenderer::statistics(SessionPhase phase) const {
    const auto rate = [&](std::uint64_t count) {
        return render_seconds_ > 0 ? static_cast<double>(count) / render_seconds_ : 0;
    };
    return {.phase = phase,
            .spp = film_->samples(),
            .samples = counts_.paths,
            .rays = counts_.rays,
            .shadow_rays = counts_.shadow_rays,
            .lamp_paths = counts_.lamp_paths,
            .environment_lookups = counts_.environment_lookups,
            .textured_hits = counts_.textured_hits,
            .passing_rays = counts_.passing_rays,
            .rejected = film_->film().rejected(),
            .render_seconds = render_seconds_,
            .samples_per_second = rate(counts_.paths),
            .rays_per_second = rate(counts_.rays + counts_.shadow_rays),
            .estimated_error = estimated_error_,
            .build_seconds = build_seconds_,
            .accel = render_scene_->accelerator().stats(),
            .memory_bytes = memory_bytes_,
            .restarts = restarts_,
            .relit = relit_,
            .shortcuts = options_.shortcuts,
            .threads = threads_,
            .adaptive = sampling_.target_error > 0,
            .spread = film_->spread(),
            .clamp_loss = clamp_loss_};
}

}  // namespace rayuela
