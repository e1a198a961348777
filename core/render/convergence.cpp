#include "core/render/convergence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayuela {

namespace {

using Kind = Reading::Kind;

/// y at x on the straight line through (x0, y0) and (x1, y1).
double on_line(double x, double x0, double y0, double x1, double y1) {
    return y0 + (x - x0) / (x1 - x0) * (y1 - y0);
}

/// The same on log-log scales: a power law.
double on_power_law(double x, double x0, double y0, double x1, double y1) {
    return std::exp(on_line(std::log(x), std::log(x0), std::log(y0), std::log(x1), std::log(y1)));
}

/// The curve's y where its x is `at`, from the two points between which, or past which, that lies.
double value_at(const Curve& curve, double CurvePoint::*x, double at, double CurvePoint::*y) {
    if (curve.size() == 1) return curve[0].*y * at / curve[0].*x;
    std::size_t next = 1;
    while (next + 1 < curve.size() && curve[next].*x < at) ++next;
    const CurvePoint &a = curve[next - 1], &b = curve[next];
    return on_line(at, a.*x, a.*y, b.*x, b.*y);
}

}  // namespace

Curve mean_curve(std::span<const ConvergenceRun> runs, std::span<const std::size_t> chosen, double load_seconds) {
    Curve curve;
    const auto n = static_cast<double>(chosen.size());
    for (std::size_t i = 0; i < runs[chosen[0]].checkpoints.size(); ++i) {
        CurvePoint point{.spp = static_cast<double>(runs[chosen[0]].checkpoints[i].spp), .seconds = load_seconds};
        for (const std::size_t run : chosen) {
            const Checkpoint& checkpoint = runs[run].checkpoints[i];
            point.seconds += (runs[run].build_cpu_seconds + checkpoint.cpu_seconds) / n;
            point.error += checkpoint.error.rel_mse / n;
        }
        if (point.error > 0) curve.push_back(point);
    }
    return curve;
}

Reading samples_to(const Curve& curve, double target) {
    const auto reached = std::ranges::find_if(curve, [&](const CurvePoint& p) { return p.error <= target; });
    if (reached == curve.begin()) return {curve.front().spp, Kind::before};
    if (reached == curve.end()) return {curve.back().spp * curve.back().error / target, Kind::beyond};
    const CurvePoint &a = *std::prev(reached), &b = *reached;
    return {on_power_law(target, a.error, a.spp, b.error, b.spp), Kind::inside};
}

Reading seconds_to(const Curve& curve, double target) {
    const Reading samples = samples_to(curve, target);
    return {value_at(curve, &CurvePoint::spp, samples.value, &CurvePoint::seconds), samples.kind};
}

Reading error_at(const Curve& curve, double seconds) {
    if (seconds < curve.front().seconds) return {curve.front().error, Kind::before};
    const double spp = value_at(curve, &CurvePoint::seconds, seconds, &CurvePoint::spp);
    const auto next = std::ranges::find_if(curve, [&](const CurvePoint& p) { return p.spp >= spp; });
    if (next == curve.end()) return {curve.back().error * curve.back().spp / spp, Kind::beyond};
    if (next == curve.begin()) return {curve.front().error, Kind::inside};
    const CurvePoint &a = *std::prev(next), &b = *next;
    return {on_power_law(spp, a.spp, a.error, b.spp, b.error), Kind::inside};
}

double convergence_slope(const Curve& curve) {
    std::vector<double> x, y;
    for (const CurvePoint& point : curve) {
        if (point.spp * 16 < curve.back().spp) continue;
        x.push_back(std::log(point.spp));
        y.push_back(std::log(point.error));
    }
    return slope(x, y);
}

Measured measure(std::span<const ConvergenceRun> runs, double load_seconds,
                 const std::function<double(const Curve&)>& statistic) {
    return bootstrap(runs.size(), [&](std::span<const std::size_t> chosen) {
        const Curve curve = mean_curve(runs, chosen, load_seconds);
        return curve.empty() ? std::numeric_limits<double>::quiet_NaN() : statistic(curve);
    });
}

}  // namespace rayuela
