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
    if (!samples.empty() && statistics.spp < kSpacing * samples.back()) return;
    samples.push_back(statistics.spp);
    seconds.push_back(statistics.render_seconds);
    error.push_back(statistics.estimated_error);
}

}  // namespace rayuela
