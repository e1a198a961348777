#include "core/render/image_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace rayuela {

namespace {

/// Keep dark pixels from dominating; the usual values.
constexpr double kSquareRegularizer = 0.01, kRegularizer = 0.01;
constexpr double kTrimmedShare = 1e-3;

double channel_mean(const Vec3d& v) {
    return (v.x + v.y + v.z) / 3;
}

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

struct PixelError {
    double unbiased;  ///< Relative square, by the product of the differences from both halves.
    double plain;     ///< By the square of the difference from their mean.
};

}  // namespace

ImageError image_error(std::span<const Vec4> image, const ReferencePair& reference) {
    const std::size_t n = image.size();
    std::vector<PixelError> pixels(n);
    ImageError error;
    double square = 0;
    Vec3d sum(0), truth(0);
    for (std::size_t i = 0; i < n; ++i) {
        Vec3d value(image[i]);
        if (!finite(value)) {
            value = Vec3d(0);
            ++error.nonfinite;
        }
        const Vec3d mean = reference.mean(i), difference = value - mean;
        const Vec3d product = (value - Vec3d(reference.a[i])) * (value - Vec3d(reference.b[i]));
        const Vec3d scale = mean * mean + kSquareRegularizer;
        pixels[i] = {channel_mean(product / scale), channel_mean(difference * difference / scale)};
        square += channel_mean(product);
        error.mape += channel_mean(glm::abs(difference) / (glm::abs(mean) + kRegularizer));
        sum += value;
        truth += mean;
    }
    const auto unbiased_sum = [](std::span<const PixelError> part) {
        return std::accumulate(part.begin(), part.end(), 0.0,
                               [](double s, const PixelError& e) { return s + e.unbiased; });
    };
    const auto count = static_cast<double>(n);
    error.rel_mse = unbiased_sum(pixels) / count;
    error.rmse = std::sqrt(std::max(0.0, square / count));
    error.mape /= count;
    error.mean_ratio = channel_mean(sum) / channel_mean(truth);

    const std::size_t kept = n - std::min(n - 1, static_cast<std::size_t>(std::ceil(kTrimmedShare * count)));
    std::ranges::nth_element(pixels, pixels.begin() + static_cast<std::ptrdiff_t>(kept - 1), {}, &PixelError::plain);
    error.worst_mille = pixels[kept - 1].plain;
    error.rel_mse_trimmed = unbiased_sum(std::span(pixels).first(kept)) / static_cast<double>(kept);
    return error;
}

double mean_ratio_uncertainty(const ReferencePair& reference) {
    // (A - B) / 2 has the variance of R. The channels of a pixel are not independent, and the pixels of a reference only
    // where its sampler made them so: how far the whole halves are apart says when they are not.
    double variance = 0, sum = 0, truth = 0;
    for (std::size_t i = 0; i < reference.a.size(); ++i) {
        const double half = 0.5 * channel_mean(Vec3d(reference.a[i]) - Vec3d(reference.b[i]));
        variance += half * half;
        sum += half;
        truth += channel_mean(reference.mean(i));
    }
    return std::max(std::sqrt(variance), std::abs(sum)) / truth;
}

}  // namespace rayuela
