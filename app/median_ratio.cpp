#include "app/median_ratio.h"

namespace rayuela {

Measured median_ratio(std::span<const double> above, std::span<const double> below) {
    return bootstrap(above.size(), [&](std::span<const std::size_t> taken) {
        std::vector<double> ratios;
        for (const std::size_t i : taken) ratios.push_back(above[i] / below[i]);
        return median(std::move(ratios));
    });
}

}  // namespace rayuela
