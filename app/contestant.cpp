#include "app/contestant.h"

#include "app/median_ratio.h"

namespace rayuela {
namespace {

/// A number that follows from the median round.
template <typename Of>
Measured of_median(std::span<const double> seconds, const Of& of) {
    return bootstrap(seconds.size(), [&](std::span<const std::size_t> taken) {
        std::vector<double> chosen;
        for (const std::size_t i : taken) chosen.push_back(seconds[i]);
        return of(median(std::move(chosen)));
    });
}

std::vector<double> seconds_a_ray(const Contestant& one) {
    std::vector<double> result;
    for (const double seconds : one.seconds) result.push_back(seconds / static_cast<double>(one.rays));
    return result;
}

}  // namespace

void compete(std::span<Contestant> contestants, int rounds, double (*clock)()) {
    for (int round = 0; round <= rounds; ++round) {
        for (Contestant& contestant : contestants) {
            contestant.reset();
            const double start = clock();
            contestant.trace();
            if (round > 0) contestant.seconds.push_back(clock() - start);
        }
    }
}

Measured mrays_per_second(const Contestant& one) {
    return of_median(one.seconds, [&](double seconds) { return static_cast<double>(one.rays) / seconds * 1e-6; });
}

Measured nanoseconds_a_ray(const Contestant& one) {
    return of_median(one.seconds, [&](double seconds) { return seconds / static_cast<double>(one.rays) * 1e9; });
}

Measured speed_ratio(const Contestant& ours, const Contestant& theirs) {
    return median_ratio(seconds_a_ray(theirs), seconds_a_ray(ours));
}

}  // namespace rayuela
