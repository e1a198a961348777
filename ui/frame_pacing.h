#pragma once

namespace rayuela {

/// What the window's loop knows when it decides whether to draw. Times in seconds of one clock.
struct FrameTiming {
    double now = 0;
    double last_draw = -1e9;       ///< When the last frame was drawn.
    double draw_cost = 0;          ///< How long that took.
    double last_input = -1e9;      ///< When the person last did something.
    int frames_since_input = 100;  ///< Drawn after that.
    double render_seconds = 0;     ///< Age of the image.
    bool published = false;        ///< A new image waits.
    bool animating = false;        ///< Something moves without events: flight, a progress bar.
};

/// Seconds that must lie between two drawings of a new image that nobody asked for: short while the image is young, and
/// never so short that drawing takes more than a small part of the time from the renderer.
double publish_interval(double draw_cost, double render_seconds);

/// Seconds until the next frame is due; 0: draw now. Infinity: sleep until an event comes.
double seconds_to_next_frame(const FrameTiming& timing);

}  // namespace rayuela
