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
constexpr int kColumns = 3;

/// Told apart by colour-blind people too (Okabe & Ito 2008).
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#f0e442"};

struct BandPoint {
    double seconds, error, low, high;
};
using Band = std::vector<BandPoint>;

/// The mean curve with the interval of its error at each checkpoint.
Band make_band(const SceneConvergence& scene, const VariantRuns& variant) {
    std::vector<std::size_t> all(variant.runs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const Curve curve = mean_curve(variant.runs, all, scene.load_cpu_seconds);
    Band band;
    for (const CurvePoint& point : curve) {
        const auto error_here = [&](const Curve& c) {
            const auto same = std::ranges::find(c, point.spp, &CurvePoint::spp);
            return same == c.end() ? std::nan("") : same->error;
        };
        const Interval interval = measure(variant.runs, scene.load_cpu_seconds, error_here).interval;
        band.push_back({point.seconds, point.error, interval.low, interval.high});
    }
    return band;
}

/// Decades that enclose what is drawn.
struct Axis {
    double low = kInfinity, high = -kInfinity;  ///< Logarithms to base 10.

    void enclose(double value) {
        low = std::min(low, std::floor(std::log10(value)));
        high = std::max(high, std::ceil(std::log10(value)));
        if (high == low) ++high;
    }
    /// Share of the axis at which `value` stands.
    double share(double value) const { return (std::log10(value) - low) / (high - low); }
};

/// One scene's plot, at (x0, y0) of the document.
class Panel {
public:
    Panel(const SceneConvergence& scene, double x0, double y0) : scene_(scene), x0_(x0), y0_(y0) {
        for (const VariantRuns& variant : scene.variants) bands_.push_back(make_band(scene, variant));
        for (const Band& band : bands_) {
            for (const BandPoint& point : band) {
                seconds_.enclose(point.seconds);
                error_.enclose(point.low);
                error_.enclose(point.high);
            }
        }
    }

    std::string svg() const {
        if (seconds_.low > seconds_.high) return "";
        std::string svg = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"title\">{}</text>\n", x0_ + kLeft,
                                      y0_ + 18, scene_.name);
        svg += grid() + guide();
        for (std::size_t i = 0; i < bands_.size(); ++i) svg += curve(bands_[i], kColors[i % kColors.size()]);
        return svg;
    }

private:
    double x(double seconds) const { return x0_ + kLeft + seconds_.share(seconds) * (kPanelWidth - kLeft - kRight); }
    double y(double error) const { return y0_ + kTop + (1 - error_.share(error)) * (kPanelHeight - kTop - kBottom); }

    std::string line(const char* kind, double ax, double ay, double bx, double by) const {
        return fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", kind, ax, ay, bx, by);
    }

    std::string grid() const {
        const double left = x(std::pow(10, seconds_.low)), right = x(std::pow(10, seconds_.high));
        const double bottom = y(std::pow(10, error_.low)), top = y(std::pow(10, error_.high));
        std::string svg;
        for (double decade = seconds_.low; decade <= seconds_.high; ++decade) {
            const double at = x(std::pow(10, decade));
            svg += line("grid", at, bottom, at, top);
            svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"middle\">{:g}</text>\n", at, bottom + 15,
                               std::pow(10, decade));
        }
        for (double decade = error_.low; decade <= error_.high; ++decade) {
            const double at = y(std::pow(10, decade));
            svg += line("grid", left, at, right, at);
            svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"end\">{:g}</text>\n", left - 5, at + 4,
                               std::pow(10, decade));
        }
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"middle\">CPU seconds</text>\n", (left + right) / 2,
                           bottom + 32);
        return svg +
               fmt::format("<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" class=\"middle\">relMSE</text>\n",
                           x0_ + 14, (top + bottom) / 2);
    }

    /// Error as 1 / seconds, through the start of the first curve, as far as the panel goes.
    std::string guide() const {
        if (bands_.empty() || bands_[0].empty()) return "";
        const auto [seconds, error, low, high] = bands_[0].front();
        const double factor = std::min(std::pow(10, seconds_.high) / seconds, error / std::pow(10, error_.low));
        return line("guide", x(seconds), y(error), x(seconds * factor), y(error / factor));
    }

    std::string curve(const Band& band, const char* color) const {
        std::string edge, middle, dots;
        for (const BandPoint& p : band) {
            edge += fmt::format("{:.1f},{:.1f} ", x(p.seconds), y(p.high));
            middle += fmt::format("{:.1f},{:.1f} ", x(p.seconds), y(p.error));
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n", x(p.seconds), y(p.error),
                                color);
        }
        for (auto p = band.rbegin(); p != band.rend(); ++p)
            edge += fmt::format("{:.1f},{:.1f} ", x(p->seconds), y(p->low));
        return fmt::format(
                   "<polygon points=\"{}\" fill=\"{}\" opacity=\"0.2\"/>\n<polyline points=\"{}\" stroke=\"{}\" "
                   "class=\"curve\"/>\n",
                   edge, color, middle, color) +
               dots;
    }

    const SceneConvergence& scene_;
    double x0_, y0_;
    std::vector<Band> bands_;
    Axis seconds_, error_;
};

std::string legend(const SceneConvergence& scene, double y0) {
    std::string svg;
    for (std::size_t i = 0; i < scene.variants.size(); ++i) {
        const double y = y0 + kLegendLine * (static_cast<double>(i) + 0.5);
        svg += fmt::format("<path d=\"M{:.1f} {:.1f}h24\" stroke=\"{}\" class=\"curve\"/>\n", kLeft, y,
                           kColors[i % kColors.size()]);
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kLeft + 30, y + 4,
                           scene.variants[i].variant.name);
    }
    return svg;
}

}  // namespace

std::string convergence_svg(const std::vector<SceneConvergence>& scenes) {
    const int count = static_cast<int>(scenes.size());
    const int columns = std::min(count, kColumns), rows = (count + kColumns - 1) / kColumns;
    const bool named = scenes[0].variants.size() > 1;
    const double legend_height = named ? kLegendLine * static_cast<double>(scenes[0].variants.size()) + 8 : 0;
    const double width = columns * kPanelWidth, height = rows * kPanelHeight + legend_height;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<style>text{{font:12px sans-serif;fill:#222}}.title{{font-weight:bold}}.middle{{text-anchor:middle}}"
        ".end{{text-anchor:end}}path{{fill:none}}.grid{{stroke:#ddd}}.guide{{stroke:#888;stroke-dasharray:2 4}}"
        ".curve{{fill:none;stroke-width:1.5}}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
    for (int i = 0; i < count; ++i) {
        svg +=
            Panel(scenes[static_cast<std::size_t>(i)], i % kColumns * kPanelWidth, i / kColumns * kPanelHeight).svg();
    }
    if (named) svg += legend(scenes[0], rows * kPanelHeight);
    return svg + "</svg>\n";
}

}  // namespace rayuela
