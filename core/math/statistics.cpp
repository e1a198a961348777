#include "core/math/statistics.h"

#include "core/math/sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace rayuela {

namespace {

constexpr std::size_t kResamples = 2000;
constexpr double kTail = 0.025;

/// Linear between the order statistics. Source: Hyndman & Fan 1996, definition 7.
double quantile(std::span<const double> sorted, double q) {
    const double position = q * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

}  // namespace

Measured bootstrap(std::size_t count, const Statistic& statistic) {
    std::vector<std::size_t> chosen(count);
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    const double value = statistic(chosen);
    std::vector<double> values;
    for (std::size_t resample = 0; resample < kResamples && count > 1; ++resample) {
        for (std::size_t i = 0; i < count; ++i) chosen[i] = mix_bits(resample * count + i + 1) % count;
        if (const double v = statistic(chosen); std::isfinite(v)) values.push_back(v);
    }
    if (values.empty()) return {value, {value, value}};
    std::ranges::sort(values);
    return {value, {quantile(values, kTail), quantile(values, 1 - kTail)}};
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

double slope(std::span<const double> x, std::span<const double> y) {
    const auto n = static_cast<double>(x.size());
    const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n, my = std::accumulate(y.begin(), y.end(), 0.0) / n;
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    return xx > 0 ? xy / xx : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace rayuela
