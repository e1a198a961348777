#include "app/bench_convergence_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace rayuela {

namespace {

constexpr double kPanelWidth = 420, kPanelHeight = 320, kLegendLine = 18;
constexpr double kLeft = 58, kRight = 14, kTop = 28, kBottom = 42;

/// Told apart by colour-blind people too (Okabe & Ito 2008).
constexpr std::array<Vec3, 8> kColors{{{0, 0.447f, 0.698f},
                                       {0.835f, 0.369f, 0},
                                       {0, 0.62f, 0.451f},
                                       {0.8f, 0.475f, 0.655f},
                                       {0.902f, 0.624f, 0},
                                       {0.337f, 0.706f, 0.914f},
                                       {0, 0, 0},
                                       {0.941f, 0.894f, 0.259f}}};

/// The mean curve with the interval of its error at each checkpoint.
PlotCurve make_curve(const SceneConvergence& scene, const VariantRuns& variant, const Vec3& color) {
    std::vector<std::size_t> all(variant.runs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    PlotCurve plot{.name = variant.variant.name, .color = color};
    for (const CurvePoint& point : mean_curve(variant.runs, all, scene.load_cpu_seconds)) {
        const auto error_here = [&](const Curve& c) {
            const auto same = std::ranges::find(c, point.spp, &CurvePoint::spp);
            return same == c.end() ? std::nan("") : same->error;
        };
        const Interval interval = measure(variant.runs, scene.load_cpu_seconds, error_here).interval;
        plot.x.push_back(point.seconds);
        plot.y.push_back(point.error);
        plot.low.push_back(interval.low);
        plot.high.push_back(interval.high);
    }
    return plot;
}

/// Error as 1 / seconds, through the start of the first curve, as far as that goes.
void add_guide(PlotPanel& panel) {
    if (panel.curves.empty() || panel.curves[0].x.empty()) return;
    const PlotCurve& curve = panel.curves[0];
    if (!(curve.x[0] > 0) || !(curve.y[0] > 0)) return;
    double lowest = curve.y[0];
    for (const double error : curve.y) lowest = error > 0 ? std::min(lowest, error) : lowest;
    const double factor = std::min(curve.x.back() / curve.x[0], curve.y[0] / lowest);
    panel.guide_x = {curve.x[0], curve.x[0] * factor};
    panel.guide_y = {curve.y[0], curve.y[0] / factor};
}

std::string hex(const Vec3& color) {
    const auto byte = [](float value) { return std::lround(255 * value); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(color.r), byte(color.g), byte(color.b));
}

/// Decades that enclose what is drawn.
struct Axis {
    double low = kInfinity, high = -kInfinity;  ///< Logarithms to base 10.

    void enclose(double value) {
        if (!(value > 0)) return;
        low = std::min(low, std::floor(std::log10(value)));
        high = std::max(high, std::ceil(std::log10(value)));
        if (high == low) ++high;
    }
    /// Share of the axis at which `value` stands.
    double share(double value) const { return value > 0 ? (std::log10(value) - low) / (high - low) : 0; }
};

/// A panel at (x0, y0) of the document.
class PanelSvg {
public:
    PanelSvg(const PlotSheet& sheet, const PlotPanel& panel, double x0, double y0)
        : sheet_(sheet), panel_(panel), x0_(x0), y0_(y0) {
        for (const PlotCurve& curve : panel.curves) {
            for (std::size_t i = 0; i < curve.x.size(); ++i) {
                x_axis_.enclose(curve.x[i]);
                y_axis_.enclose(curve.low[i]);
                y_axis_.enclose(curve.high[i]);
            }
        }
    }

    std::string svg() const {
        if (x_axis_.low > x_axis_.high || y_axis_.low > y_axis_.high) return "";
        std::string svg = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"title\">{}</text>\n", x0_ + kLeft,
                                      y0_ + 18, panel_.title);
        svg += grid();
        const auto &gx = panel_.guide_x, &gy = panel_.guide_y;
        if (!gx.empty()) svg += line("guide", x(gx[0]), y(gy[0]), x(gx[1]), y(gy[1]));
        for (const PlotCurve& one : panel_.curves) svg += curve(one);
        return svg;
    }

private:
    double x(double value) const { return x0_ + kLeft + x_axis_.share(value) * (kPanelWidth - kLeft - kRight); }
    double y(double value) const { return y0_ + kTop + (1 - y_axis_.share(value)) * (kPanelHeight - kTop - kBottom); }

    std::string line(const char* kind, double ax, double ay, double bx, double by) const {
        return fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", kind, ax, ay, bx, by);
    }

    std::string grid() const {
        const double left = x(std::pow(10, x_axis_.low)), right = x(std::pow(10, x_axis_.high));
        const double bottom = y(std::pow(10, y_axis_.low)), top = y(std::pow(10, y_axis_.high));
        std::string svg;
        for (double decade = x_axis_.low; decade <= x_axis_.high; ++decade) {
            const double at = x(std::pow(10, decade));
            svg += line("grid", at, bottom, at, top);
            svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"middle\">{:g}</text>\n", at, bottom + 15,
                               std::pow(10, decade));
        }
        for (double decade = y_axis_.low; decade <= y_axis_.high; ++decade) {
            const double at = y(std::pow(10, decade));
            svg += line("grid", left, at, right, at);
            svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"end\">{:g}</text>\n", left - 5, at + 4,
                               std::pow(10, decade));
        }
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"middle\">{}</text>\n", (left + right) / 2,
                           bottom + 32, sheet_.x_label);
        return svg +
               fmt::format("<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" class=\"middle\">{}</text>\n",
                           x0_ + 14, (top + bottom) / 2, sheet_.y_label);
    }

    std::string curve(const PlotCurve& curve) const {
        const std::string color = hex(curve.color);
        std::string edge, middle, dots;
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            edge += fmt::format("{:.1f},{:.1f} ", x(curve.x[i]), y(curve.high[i]));
            middle += fmt::format("{:.1f},{:.1f} ", x(curve.x[i]), y(curve.y[i]));
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n", x(curve.x[i]),
                                y(curve.y[i]), color);
        }
        for (std::size_t i = curve.x.size(); i-- > 0;)
            edge += fmt::format("{:.1f},{:.1f} ", x(curve.x[i]), y(curve.low[i]));
        return fmt::format(
                   "<polygon points=\"{}\" fill=\"{}\" opacity=\"0.2\"/>\n<polyline points=\"{}\" stroke=\"{}\" "
                   "class=\"curve\"/>\n",
                   edge, color, middle, color) +
               dots;
    }

    const PlotSheet& sheet_;
    const PlotPanel& panel_;
    double x0_, y0_;
    Axis x_axis_, y_axis_;
};

std::string legend(const PlotPanel& panel, double y0) {
    std::string svg;
    for (std::size_t i = 0; i < panel.curves.size(); ++i) {
        const double y = y0 + kLegendLine * (static_cast<double>(i) + 0.5);
        svg += fmt::format("<path d=\"M{:.1f} {:.1f}h24\" stroke=\"{}\" class=\"curve\"/>\n", kLeft, y,
                           hex(panel.curves[i].color));
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kLeft + 30, y + 4, panel.curves[i].name);
    }
    return svg;
}

}  // namespace

PlotSheet convergence_plot(const std::vector<SceneConvergence>& scenes) {
    constexpr int kColumns = 3;
    PlotSheet sheet{.x_label = "CPU seconds",
                    .y_label = "relMSE",
                    .panels = {},
                    .columns = std::min(static_cast<int>(scenes.size()), kColumns)};
    for (const SceneConvergence& scene : scenes) {
        PlotPanel panel{.title = scene.name, .curves = {}, .guide_x = {}, .guide_y = {}};
        for (std::size_t i = 0; i < scene.variants.size(); ++i)
            panel.curves.push_back(make_curve(scene, scene.variants[i], kColors[i % kColors.size()]));
        add_guide(panel);
        sheet.panels.push_back(std::move(panel));
    }
    return sheet;
}

std::string plot_svg(const PlotSheet& sheet) {
    const int count = static_cast<int>(sheet.panels.size()), rows = (count + sheet.columns - 1) / sheet.columns;
    const double lines = sheet.has_legend() ? static_cast<double>(sheet.panels[0].curves.size()) : 0;
    const double width = sheet.columns * kPanelWidth;
    const double height = rows * kPanelHeight + (lines > 0 ? kLegendLine * lines + 8 : 0);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<style>text{{font:12px sans-serif;fill:#222}}.title{{font-weight:bold}}.middle{{text-anchor:middle}}"
        ".end{{text-anchor:end}}path{{fill:none}}.grid{{stroke:#ddd}}.guide{{stroke:#888;stroke-dasharray:2 4}}"
        ".curve{{fill:none;stroke-width:1.5}}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
    for (int i = 0; i < count; ++i) {
        svg += PanelSvg(sheet, sheet.panels[static_cast<std::size_t>(i)], i % sheet.columns * kPanelWidth,
                        i / sheet.columns * kPanelHeight)
                   .svg();
    }
    if (sheet.has_legend()) svg += legend(sheet.panels[0], rows * kPanelHeight);
    return svg + "</svg>\n";
}

}  // namespace rayuela
