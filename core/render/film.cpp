#include "core/render/film.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

namespace rayuela {

namespace {

/// Keeps dark pixels from dominating the relative error; the usual value.
constexpr double kDarkRegularizer = 0.01;

double luminance(const Vec3d& c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

}  // namespace

std::optional<Rejection> rejection(const Color& radiance) {
    if (glm::any(glm::isnan(radiance))) return Rejection::nan;
    if (glm::any(glm::isinf(radiance))) return Rejection::infinite;
    if (glm::any(glm::lessThan(radiance, Color(0)))) return Rejection::negative;
    return std::nullopt;
}

Film::Film(int width, int height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Film::add(std::size_t pixel, std::uint32_t sample, const Color& radiance) {
    if (const auto cause = rejection(radiance)) {
        rejected_[static_cast<std::size_t>(*cause)].fetch_add(1, std::memory_order_relaxed);
        return;
    }
    Pixel& p = pixels_[pixel];
    const Vec3d value(radiance);
    const double y = luminance(value);
    const std::uint32_t half = sample_half(sample);
    p.sum[half] += value;
    p.luminance_squared += y * y;
    ++p.count[half];
}

void Film::clear_rejected() {
    for (auto& count : rejected_) count = 0;
}

Vec3d Film::mean(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    const std::uint64_t n = count(pixel);
    return n ? (p.sum[0] + p.sum[1]) / static_cast<double>(n) : Vec3d(0);
}

double Film::variance_of_mean(std::size_t pixel) const {
    const auto n = static_cast<double>(count(pixel));
    if (n < 2) return 0;
    const double y = luminance(mean(pixel));
    return std::max(0.0, pixels_[pixel].luminance_squared / n - y * y) / (n - 1);
}

Image Film::image() const {
    Image image{width_, height_, std::vector<Vec4>(pixels_.size()), {}};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels_.size(), 16384), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) image.pixels[i] = Vec4(Color(mean(i)), 1.0f);
    });
    return image;
}

double Film::relative_error() const {
    struct Sum {
        double error = 0;
        bool complete = true;
    };
    const auto add_range = [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Pixel& p = pixels_[i];
            const auto na = static_cast<double>(p.count[0]), nb = static_cast<double>(p.count[1]);
            if (na == 0 || nb == 0) {
                sum.complete = false;
                continue;
            }
            const Vec3d difference = p.sum[0] / na - p.sum[1] / nb;
            const Vec3d square = difference * difference * (na * nb / ((na + nb) * (na + nb)));
            const Vec3d m = mean(i);
            const Vec3d error = square / (m * m + kDarkRegularizer);
            sum.error += (error.x + error.y + error.z) / 3;
        }
        return sum;
    };
    const auto join = [](const Sum& a, const Sum& b) { return Sum{a.error + b.error, a.complete && b.complete}; };
    const tbb::blocked_range<std::size_t> all(0, pixels_.size(), 16384);
    const Sum sum = tbb::parallel_deterministic_reduce(all, Sum{}, add_range, join);
    return sum.complete ? sum.error / static_cast<double>(pixels_.size()) : 0;
}

std::array<std::uint64_t, kRejectionCount> Film::rejected() const {
    std::array<std::uint64_t, kRejectionCount> counts{};
    for (std::size_t i = 0; i < kRejectionCount; ++i) counts[i] = rejected_[i];
    return counts;
}

}  // namespace rayuela
