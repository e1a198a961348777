#pragma once

#include "app/bench_convergence.h"
#include "ui/plot_image.h"

namespace rayuela {

/// relMSE over CPU seconds on log-log scales: a panel a scene, a curve a variant, its 95% interval as a band, and a dotted line
/// of slope -1.
PlotSheet convergence_plot(const std::vector<SceneConvergence>& scenes);

/// As an SVG document.
std::string plot_svg(const PlotSheet& sheet);

}  // namespace rayuela
