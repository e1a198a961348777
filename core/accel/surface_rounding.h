#pragma once

#include "core/math/float_error.h"

namespace rayuela {

/// SurfacePoint::p_error of a point p in double is kSurfaceRounding |p| for its rounding to float and kSurfaceDoubleError of the
/// numbers it was made from for all roundings before. The smallest term keeps the bound positive where the surface passes
/// through the origin.
inline constexpr double kSurfaceRounding = 1.01 * double{kUnitRoundoff};
inline constexpr double kSurfaceDoubleError = 0x1p-36;
inline constexpr double kSurfaceSmallestError = 0x1p-100;

/// A point p is kept from the edges of its surface by this fraction of its numbers: so far that rounding to float does not
/// take it beyond a wall that meets the surface there, and lets light into a sealed room.
inline constexpr double kEdgeMargin = 3 * double{kUnitRoundoff};
/// In a triangle it moves towards the centroid, by as many margins as one needs whose height is an eighth of its extent.
inline constexpr double kTriangleMargins = 24;

}  // namespace rayuela
