#include "core/render/schedule.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

constexpr double kCoarseSeconds = 0.012;      ///< Of a pass for one edit: room to draw 30 times a second in software.
constexpr double kQuietSeconds = 0.08;        ///< Without edits, after which the film's turn has come.
constexpr int kCoarsestDivisor = 16;          ///< Below this a preview shows nothing.
constexpr double kGuessedPathSeconds = 2e-6;  ///< Before anything was measured.
constexpr double kHeadlessPassSeconds = 0.25;
/// After which to ask again whether the trees are there: whoever builds them says so.
constexpr double kDraftSeconds = 1;
constexpr int kMaxPassSamples = 64;

double path_seconds(const ScheduleState& state) {
    return state.seconds_per_path > 0 ? state.seconds_per_path : kGuessedPathSeconds;
}

/// Of one sample in every pixel of the film.
double film_seconds(const ScheduleState& state) {
    return path_seconds(state) * state.width * state.height;
}

/// By how much a side of the film is divided so that a pass takes kCoarseSeconds; 1 where the film itself does.
int coarse_divisor(const ScheduleState& state) {
    const double divisor = std::ceil(std::sqrt(film_seconds(state) / kCoarseSeconds));
    return static_cast<int>(std::clamp(divisor, 1.0, double{kCoarsestDivisor}));
}

double publish_interval(const ScheduleState& state) {
    const double calm = std::clamp(0.05 * state.render_seconds, 1.0 / 60, 0.5);
    return std::max(calm, 10 * state.publish_seconds);
}

bool previewing(const ScheduleState& state) {
    return state.interactive && state.samples == 0;
}

/// Samples a pixel of a pass that ends about when the next publication is due.
int pass_samples(const ScheduleState& state) {
    if (state.samples == 0) return 1;
    const double target = state.interactive ? publish_interval(state) : kHeadlessPassSeconds;
    const double seconds = film_seconds(state) * state.unfinished;
    return static_cast<int>(std::clamp(target / seconds, 1.0, double{kMaxPassSamples}));
}

}  // namespace

Pass next_pass(const ScheduleState& state) {
    if (previewing(state) && !state.preview_done && coarse_divisor(state) > 1) {
        return {.kind = Pass::Kind::coarse, .divisor = coarse_divisor(state)};
    }
    if (previewing(state) && state.preview_done && state.quiet_seconds < kQuietSeconds) {
        return {.kind = Pass::Kind::wait, .wait_seconds = kQuietSeconds - state.quiet_seconds};
    }
    const bool complete = state.samples > 0;
    const bool sampled = state.max_samples > 0 && state.samples >= state.max_samples;
    const bool timed_out = state.max_seconds > 0 && complete && state.render_seconds >= state.max_seconds;
    const bool converged = complete && state.unfinished == 0;
    if (sampled || timed_out || converged) return {.kind = Pass::Kind::finished};
    if (state.paused && complete) return {.kind = Pass::Kind::paused};
    if (state.drafted && (complete || state.preview_done))
        return {.kind = Pass::Kind::wait, .wait_seconds = kDraftSeconds};

    if (state.interactive && complete && state.since_relit < kQuietSeconds) {
        const double end = state.render_seconds + kCoarseSeconds;
        return {.kind = Pass::Kind::brief,
                .samples = state.samples + 1,
                .stop_at = state.max_seconds > 0 ? std::min(end, state.max_seconds) : end};
    }
    int samples = state.samples + pass_samples(state);
    if (state.max_samples > 0) samples = std::min(samples, state.max_samples);
    return {.kind = Pass::Kind::full, .samples = samples, .stop_at = complete ? state.max_seconds : 0};
}

bool publish_now(const ScheduleState& state) {
    if (!state.unpublished || state.samples == 0) return false;
    const Pass::Kind next = next_pass(state).kind;
    if (next == Pass::Kind::paused || next == Pass::Kind::finished) return true;
    return state.interactive && (!state.film_shown || state.since_publication >= publish_interval(state));
}

}  // namespace rayuela
