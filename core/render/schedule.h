#pragma once

#include "core/scene/scene.h"

namespace rayuela {

/// What the choice of the next pass depends on. All times in seconds.
struct ScheduleState {
    int width = 1, height = 1;  ///< Of the film.
    bool interactive = true;    ///< Coarse passes and publications while rendering.
    bool paused = false;
    bool drafted = false;    ///< The trees are drafts, and better ones are being built.
    int max_samples = 0;     ///< 0: no limit.
    double max_seconds = 0;  ///< 0: no limit.

    int samples = 0;        ///< In every pixel of the film that gets more.
    double unfinished = 1;  ///< Share of a sample of every pixel that is left to do; 0: the target error is reached.
    bool preview_done = false;    ///< A coarse pass since accumulation restarted.
    double render_seconds = 0;    ///< In passes since the restart.
    double quiet_seconds = 0;     ///< Since the last edit.
    double seconds_per_path = 0;  ///< Wall time of a camera path as last measured; 0 while unknown.
    double publish_seconds = 0;   ///< Cost of a publication as last measured.
    double since_publication = 0;
    bool unpublished = false;  ///< The film has samples that no frame shows.
    bool film_shown = false;   ///< A frame has shown the film since the restart.
    double since_relit = 1e9;  ///< Since an edit of light has scaled the film.
};

struct Pass {
    enum class Kind : std::uint8_t {
        coarse,  ///< A preview, one sample a pixel; not cut short even by an edit: else a stream of them shows nothing.
        wait,    ///< Nothing for `wait_seconds`, unless an edit comes: the window may draw what there is.
        full,    ///< The film.
        brief,   ///< The film while edits scale it: for a moment, and not cut short by an edit either.
        paused,  ///< Nothing, until resumed.
        finished,  ///< Nothing: a limit or the target error is reached.
    };
    Kind kind = Kind::full;
    int divisor = 1;  ///< Of the film's width and height.
    int samples = 0;  ///< Full, brief: that every pixel that is not finished shall have at the end.
    double wait_seconds = 0;
    double stop_at = 0;  ///< Value of render_seconds that cuts the pass short; 0: never.

    bool operator==(const Pass&) const = default;
};

/// What to render next. Pure: the session does as it says.
/// While edits come that scale the film, passes over it are brief: each edit is shown before the next pass.
/// After a restart comes a preview, small enough for some 40 edits a second, and once edits have ceased to come the film. The first pass over the film always completes, so that no frame shows holes. Paused, it stops after that.
/// While trees are drafts the threads are left to those who build better ones: nothing follows the first image.
Pass next_pass(const ScheduleState& state);

/// Whether the film is worth publishing, after a pass over it: at once when it has become complete or rendering is about
/// to stop, else 60 times a second falling to twice as the image calms down, and for no more than a tenth of the time.
bool publish_now(const ScheduleState& state);

}  // namespace rayuela
