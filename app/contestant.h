#pragma once

#include "core/math/statistics.h"

#include <functional>
#include <string>

namespace rayuela {

/// Somebody who answers all rays of a set, and how long each round took.
struct Contestant {
    std::string name;
    std::function<void()> reset, trace;
    std::size_t rays;  ///< That `trace` answers.
    std::vector<double> seconds{};
};

/// Lets them trace in turns, as often as `rounds` says after a first one that warms up. `clock` counts seconds.
void compete(std::span<Contestant> contestants, int rounds, double (*clock)());

/// Of the median round.
Measured mrays_per_second(const Contestant& one);
Measured nanoseconds_a_ray(const Contestant& one);
/// Of the speeds in the same rounds.
Measured speed_ratio(const Contestant& ours, const Contestant& theirs);

}  // namespace rayuela
