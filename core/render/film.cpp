#include "core/render/film.h"

#include "core/accel/parallel.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// Pixels a task.
constexpr std::size_t kGrain = 16384;

double luminance(const Vec3d& c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/// Of a pixel or of its splats.
void scale_sums(auto& sums, const Vec3d& factor) {
    const double before = luminance(sums.sum[0] + sums.sum[1]);
    for (Vec3d& sum : sums.sum) sum *= factor;
    const double ratio = before > 0 ? luminance(sums.sum[0] + sums.sum[1]) / before : 0;
    sums.luminance_squared *= ratio * ratio;
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
    if (count_rejection(radiance)) return;
    Pixel& p = pixels_[pixel];
    const Vec3d value(radiance);
    const double y = luminance(value);
    const std::uint32_t half = sample_half(sample);
    p.sum[half] += value;
    p.luminance_squared += y * y;
    ++p.count[half];
}

void Film::splat(std::size_t pixel, std::uint32_t round, const Color& radiance) {
    if (count_rejection(radiance)) return;
    if (splats_.empty()) splats_.resize(pixels_.size());
    const Vec3d value(radiance);
    const double y = luminance(value);
    splats_[pixel].sum[sample_half(round)] += value;
    splats_[pixel].luminance_squared += y * y;
}

void Film::end_round(std::uint32_t round) {
    ++rounds_[sample_half(round)];
}

void Film::clear_splats() {
    splats_.clear();
    rounds_ = {};
}

void Film::scale(const Vec3d& factor) {
    parallel_ranges(pixels_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) scale_sums(pixels_[i], factor);
        if (splats_.empty()) return;
        for (std::size_t i = begin; i < end; ++i) scale_sums(splats_[i], factor);
    });
}

bool Film::count_rejection(const Color& radiance) {
    const auto cause = rejection(radiance);
    if (cause) rejected_[static_cast<std::size_t>(*cause)].fetch_add(1, std::memory_order_relaxed);
    return cause.has_value();
}

void Film::clear_rejected() {
    for (auto& count : rejected_) count = 0;
}

double Film::luminance_sum(std::size_t pixel, std::size_t half) const {
    return luminance(pixels_[pixel].sum[half]);
}

Vec3d Film::mean(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    const std::uint64_t n = count(pixel);
    Vec3d of_samples(0);
    if (weighs_halves_alike(p)) {
        of_samples = 0.5 * (p.sum[0] / static_cast<double>(p.count[0]) + p.sum[1] / static_cast<double>(p.count[1]));
    } else if (n > 0) {
        of_samples = (p.sum[0] + p.sum[1]) / static_cast<double>(n);
    }
    if (splats_.empty()) return of_samples;
    return of_samples + (splats_[pixel].sum[0] + splats_[pixel].sum[1]) / static_cast<double>(rounds());
}

Vec3d Film::half_mean(std::size_t pixel, std::size_t half) const {
    const Vec3d of_samples = pixels_[pixel].sum[half] / static_cast<double>(pixels_[pixel].count[half]);
    if (splats_.empty()) return of_samples;
    return of_samples + splats_[pixel].sum[half] / static_cast<double>(rounds_[half]);
}

double Film::variance_of_mean(std::size_t pixel) const {
    const auto n = static_cast<double>(count(pixel));
    if (n < 2) return 0;
    const Pixel& p = pixels_[pixel];
    const double y = luminance((p.sum[0] + p.sum[1]) / n);
    const double of_sample = std::max(0.0, p.luminance_squared / n - y * y) * n / (n - 1);
    const double of_samples = of_sample * (weighs_halves_alike(p) ? (1.0 / p.count[0] + 1.0 / p.count[1]) / 4 : 1 / n);
    if (splats_.empty()) return of_samples;
    // Splats are rare among the many paths of a round: their squares alone are nearly the variance.
    const double rounds_done = rounds();
    return of_samples + splats_[pixel].luminance_squared / (rounds_done * rounds_done);
}

Image Film::image() const {
    Image image{width_, height_, std::vector<Vec4>(pixels_.size()), {}};
    parallel_ranges(pixels_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) image.pixels[i] = Vec4(Color(mean(i)), 1.0f);
    });
    return image;
}

double Film::splat_deviation() const {
    if (splats_.empty() || rounds_[0] == 0 || rounds_[1] == 0) return 0;
    const double a = rounds_[0], b = rounds_[1];
    double sum = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        const double difference = luminance(splats_[i].sum[0] / a) - luminance(splats_[i].sum[1] / b);
        const double shown = luminance(mean(i));
        sum += difference * difference / (shown * shown + kDarkRegularizer);
    }
    return std::sqrt(sum / static_cast<double>(pixels_.size()) / (1 / a + 1 / b));
}

double Film::relative_error() const {
    struct Sum {
        double error = 0;
        bool complete = true;
    };
    const auto sum_of = [&](std::size_t begin, std::size_t end) {
        Sum sum;
        for (std::size_t i = begin; i < end; ++i) {
            const Pixel& p = pixels_[i];
            const auto na = static_cast<double>(p.count[0]), nb = static_cast<double>(p.count[1]);
            if (na == 0 || nb == 0 || (!splats_.empty() && (rounds_[0] == 0 || rounds_[1] == 0))) {
                sum.complete = false;
                continue;
            }
            const Vec3d difference = half_mean(i, 0) - half_mean(i, 1);
            const double weights = weighs_halves_alike(p) ? 0.25 : na * nb / ((na + nb) * (na + nb));
            const Vec3d square = difference * difference * weights;
            const Vec3d m = mean(i);
            const Vec3d error = square / (m * m + kDarkRegularizer);
            sum.error += (error.x + error.y + error.z) / 3;
        }
        return sum;
    };
    const auto join = [](const Sum& a, const Sum& b) { return Sum{a.error + b.error, a.complete && b.complete}; };
    const Sum sum = parallel_sum(0, pixels_.size(), kGrain, sum_of, join);
    return sum.complete ? sum.error / static_cast<double>(pixels_.size()) : 0;
}

std::array<std::uint64_t, kRejectionCount> Film::rejected() const {
    std::array<std::uint64_t, kRejectionCount> counts{};
    for (std::size_t i = 0; i < kRejectionCount; ++i) counts[i] = rejected_[i];
    return counts;
}

}  // namespace rayuela
