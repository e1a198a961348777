#pragma once

#include "core/math/statistics.h"

#include <string>

namespace rayuela {

/// How long somebody took for something with so many threads, in each round.
struct ScalingRun {
    std::string what, who;
    int threads;
    double work;  ///< How much was done.
    std::vector<double> seconds;
};

struct ScalingFigure {
    std::string what, who;
    int threads;
    double seconds;  ///< The median.
    double speed;    ///< Work a second in the median round.
    Measured speed_up;
};

/// A figure a run. Speed-ups are over the first run of the same two for the same work, round by round.
std::vector<ScalingFigure> scaling_figures(std::span<const ScalingRun> runs);

}  // namespace rayuela
