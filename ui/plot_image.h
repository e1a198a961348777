#pragma once

#include "core/math/image.h"
#include "core/math/result.h"

#include <string>
#include <vector>

namespace rayuela {

/// A curve and the band around it. What is not above 0 has no place on logarithmic scales.
struct PlotCurve {
    std::string name;
    Vec3 color;  ///< sRGB.
    std::vector<double> x, y, low, high;
};
/// One plot on log-log scales.
struct PlotPanel {
    std::string title;
    std::vector<PlotCurve> curves;
    std::vector<double> guide_x, guide_y;  ///< A faint line; may be empty.
};
struct PlotSheet {
    std::string x_label, y_label;
    std::vector<PlotPanel> panels;
    int columns = 1;

    bool has_legend() const { return !panels.empty() && panels[0].curves.size() > 1; }
};

/// Draws it off-screen. Values in [0, 1] as displayed.
Result<Image> plot_image(const PlotSheet& sheet);

}  // namespace rayuela
