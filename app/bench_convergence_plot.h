#pragma once

#include "app/bench_convergence.h"

namespace rayuela {

/// relMSE over CPU seconds on log-log scales as an SVG document: a panel a scene, a curve a variant, its 95% interval as a
/// band, and a dotted line of slope -1.
std::string convergence_svg(const std::vector<SceneConvergence>& scenes);

}  // namespace rayuela
