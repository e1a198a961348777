#include "app/scaling.h"

#include "app/median_ratio.h"

#include <algorithm>

namespace rayuela {

std::vector<ScalingFigure> scaling_figures(std::span<const ScalingRun> runs) {
    std::vector<ScalingFigure> figures;
    for (const ScalingRun& run : runs) {
        const auto first = std::ranges::find_if(
            runs, [&](const ScalingRun& other) { return other.what == run.what && other.who == run.who; });
        const double seconds = median(run.seconds);
        figures.push_back({.what = run.what,
                           .who = run.who,
                           .threads = run.threads,
                           .seconds = seconds,
                           .speed = run.work / seconds,
                           .speed_up = median_ratio(first->seconds, run.seconds)});
    }
    return figures;
}

}  // namespace rayuela
