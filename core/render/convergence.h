#pragma once

#include "core/math/statistics.h"
#include "core/render/image_error.h"

#include <functional>
#include <span>
#include <vector>

namespace rayuela {

/// What an image has cost so far and how good it is.
struct Checkpoint {
    int spp = 0;
    double cpu_seconds = 0, wall_seconds = 0;  ///< Of rendering alone.
    ImageError error;
};

/// One seed's way through the same numbers of samples, ascending.
struct ConvergenceRun {
    double build_cpu_seconds = 0, build_wall_seconds = 0;  ///< From the scene to the first ray.
    std::vector<Checkpoint> checkpoints;
};

struct CurvePoint {
    double spp = 0, seconds = 0, error = 0;
};
/// Error against cost, ascending in both spp and seconds.
using Curve = std::vector<CurvePoint>;

/// The mean of the chosen runs: relMSE over CPU seconds, building and `load_seconds` included. Points whose mean error is not
/// above 0 (they are better than the reference) are left out.
Curve mean_curve(std::span<const ConvergenceRun> runs, std::span<const std::size_t> chosen, double load_seconds);

/// A number read off a curve.
struct Reading {
    enum class Kind {
        inside,  ///< Between measured points, along the line that joins them on log-log scales.
        beyond,  ///< Past the last, as if error fell as 1 / samples.
        before,  ///< Reached at the first point already, which is what stands here: a bound.
    };
    double value = 0;
    Kind kind = Kind::inside;
};

/// Samples after which the error falls below `target` for the first time. The curve must not be empty.
Reading samples_to(const Curve& curve, double target);
/// CPU seconds to the same; the time of a sample is taken as constant between points.
Reading seconds_to(const Curve& curve, double target);
/// The error after so many CPU seconds.
Reading error_at(const Curve& curve, double seconds);

/// Slope of log error over log samples, over the last four doublings: -1 for independent samples. A slope near 0 is bias.
double convergence_slope(const Curve& curve);

/// A statistic of the mean curve of the runs with its bootstrap interval over the seeds; NaN where the curve is empty.
Measured measure(std::span<const ConvergenceRun> runs, double load_seconds,
                 const std::function<double(const Curve&)>& statistic);

}  // namespace rayuela
