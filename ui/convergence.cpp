#include "ui/convergence.h"

namespace rayuela {

void ConvergenceHistory::add(const RenderStatistics& statistics) {
    constexpr double kSpacing = 1.02;
    if (statistics.restarts != restarts_) {
        samples.clear();
        seconds.clear();
        error.clear();
        restarts_ = statistics.restarts;
    }
    if (statistics.estimated_error <= 0 || statistics.render_seconds <= 0) return;
    const double mean_samples = statistics.adaptive ? statistics.spread.mean : statistics.spp;
    if (!samples.empty() && mean_samples < kSpacing * samples.back()) return;
    samples.push_back(mean_samples);
    seconds.push_back(statistics.render_seconds);
    error.push_back(statistics.estimated_error);
}

}  // namespace rayuela
