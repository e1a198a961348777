#pragma once

#include "core/math/statistics.h"

namespace rayuela {

/// The median of above[i] / below[i], which the same rounds measured, and its interval. The spans are of one size.
Measured median_ratio(std::span<const double> above, std::span<const double> below);

}  // namespace rayuela
