#pragma once

#include "core/math/float_error.h"

namespace rayuela {

/// SurfacePoint::p_error of a point p in double is kSurfaceRounding |p| for its rounding to float and kSurfaceDoubleError of the
/// numbers it was made from for all roundings before. The smallest term keeps the bound positive where the surface passes
/// through the origin.
inline constexpr double kSurfaceRounding = 1.01 * double{kUnitRoundoff};
inline constexpr double kSurfaceDoubleError = 0x1p-36;
inline constexpr double kSurfaceSmallestError = 0x1p-100;

}  // namespace rayuela
