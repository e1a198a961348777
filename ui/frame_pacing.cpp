#include "ui/frame_pacing.h"

#include <algorithm>
#include <limits>

namespace rayuela {

namespace {

constexpr double kShortest = 1.0 / 60;
constexpr double kLongest = 0.5;
constexpr double kLargestShare = 0.08;  ///< Of the time, for drawing images that nobody asked for.
constexpr double kShareOfAge = 0.02;    ///< An image 2 % older looks the same.
constexpr double kSettling = 0.6;       ///< After an input: tooltips appear, hovering fades.
constexpr int kSettlingFrames = 3;      ///< What a click changes is seen by what was drawn before it one frame later.
constexpr double kSettlingFrame = 1.0 / 30;

}  // namespace

double publish_interval(double draw_cost, double render_seconds) {
    const double affordable = draw_cost / kLargestShare;
    return std::clamp(std::max(affordable, kShareOfAge * render_seconds), kShortest, kLongest);
}

double seconds_to_next_frame(const FrameTiming& timing) {
    double due = std::numeric_limits<double>::infinity();
    const bool settling = timing.now - timing.last_input < kSettling || timing.frames_since_input < kSettlingFrames;
    // What a person has just touched must follow at once: then the image may take its share of the time.
    if (timing.published) {
        due = timing.last_draw + (settling ? kShortest : publish_interval(timing.draw_cost, timing.render_seconds));
    }
    if (timing.animating) due = std::min(due, timing.last_draw + kShortest);
    if (settling) due = std::min(due, timing.last_draw + kSettlingFrame);
    if (timing.frames_since_input == 0) due = std::min(due, timing.last_draw + kShortest);
    return std::max(0.0, due - timing.now);
}

}  // namespace rayuela
