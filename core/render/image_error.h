#pragma once

#include "core/math/vec.h"

#include <cstddef>
#include <span>

namespace rayuela {

/// The truth as far as it is known: two renders A and B of the same image, independent of each other and of the image
/// that is judged. R = (A + B) / 2.
struct ReferencePair {
    std::span<const Vec4> a, b;

    Vec3d mean(std::size_t pixel) const { return 0.5 * (Vec3d(a[pixel]) + Vec3d(b[pixel])); }
};

/// How far an image I is from the truth. Means are over pixels and channels; pixels that are not finite count as black.
struct ImageError {
    /// Mean of (I - A)(I - B) / (R^2 + 0.01). The noise of A and B drops out of its expectation, so that it can be
    /// negative where the image is better than the reference.
    double rel_mse = 0;
    /// The same without the 0.1% of the pixels (rounded up) whose (I - R)^2 / (R^2 + 0.01) is largest.
    double rel_mse_trimmed = 0;
    double rmse = 0;         ///< Root of the mean of (I - A)(I - B); 0 where that is negative.
    double mape = 0;         ///< Mean of |I - R| / (R + 0.01), the reference's noise included.
    double worst_mille = 0;  ///< The 99.9th percentile over pixels of (I - R)^2 / (R^2 + 0.01).
    double mean_ratio = 0;   ///< Mean of I over mean of R: 1 without bias.
    std::size_t nonfinite = 0;
};

/// All of the same size, not empty. Alpha is ignored.
ImageError image_error(std::span<const Vec4> image, const ReferencePair& reference);

/// Standard error that the noise of the reference gives ImageError::mean_ratio, from the difference of its halves.
double mean_ratio_uncertainty(const ReferencePair& reference);

}  // namespace rayuela
