#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace rayuela {

struct Interval {
    double low = 0, high = 0;
};

/// A number worked out from measurements, and where it may as well lie.
struct Measured {
    double value = 0;
    Interval interval;  ///< Of 95%.
};

/// A statistic of `count` measurements, taken of those whose numbers are given, repetitions included.
using Statistic = std::function<double(std::span<const std::size_t>)>;

/// The statistic of all measurements and its 95% percentile bootstrap interval (Efron 1979) from 2000 resamples, the same on
/// every call. Resamples whose statistic is not finite do not take part; of one measurement the interval is empty.
Measured bootstrap(std::size_t count, const Statistic& statistic);

/// Of at least one value: the upper of the two in the middle where they are even.
double median(std::vector<double> values);

/// Least-squares slope of y over x; NaN below two different x.
double slope(std::span<const double> x, std::span<const double> y);

}  // namespace rayuela
