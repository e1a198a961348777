#include "core/render/adaptive_block.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rayuela {

namespace {

/// Earlier octaves are too short to be measured.
constexpr std::uint32_t kFirstMeasured = AdaptiveBlock::kMinSamples / 2;

/// Samples of one half among the first `samples` of a pixel.
int samples_of_half(std::size_t half, int samples) {
    if (samples < 2) return half == 0 ? samples : 0;
    const int octave = static_cast<int>(std::bit_floor(static_cast<unsigned>(samples)));
    const int later = samples - octave;
    return octave / 2 + (half == 0 ? std::min(later, octave / 2) : std::max(0, later - octave / 2));
}

}  // namespace

void AdaptiveBlock::restart() {
    measured_from_ = updates_ = 0;
    halves_ = {};
}

void AdaptiveBlock::start_measuring(int samples) {
    measured_from_ = samples;
    updates_ = 0;
    for (Half& half : halves_) half.variance = half.sum = half.count = half.rays = 0;
    contrast_.resize(pixels_);  // set to 0 where an octave begins
}

void AdaptiveBlock::measure(std::size_t pixel, std::uint32_t sample, float y) {
    if (sample < kFirstMeasured) return;
    const int octave = std::bit_width(sample) - 1;
    if (std::has_single_bit(sample)) contrast_[pixel] = {};
    if (!std::isfinite(y) || y < 0) return;
    const std::uint32_t half = sample_half(sample);
    const bool second = (sample >> (octave - 2)) & 1;
    contrast_[pixel][half] += second ? -y : y;
    halves_[half].sum += static_cast<double>(y);
    halves_[half].count += 1;
}

void AdaptiveBlock::add_cost(std::uint32_t sample, std::uint64_t rays) {
    if (sample >= kFirstMeasured) halves_[sample_half(sample)].rays += static_cast<double>(rays);
}

void AdaptiveBlock::update_noise(int samples) {
    if (measured_from_ > samples / 2) return;  // the octave has not been measured from its beginning
    const double samples_measured = samples / 4;
    for (std::size_t h = 0; h < halves_.size(); ++h) {
        Half& half = halves_[h];
        double squares = 0;
        for (const auto& contrast : contrast_)
            squares += static_cast<double>(contrast[h]) * static_cast<double>(contrast[h]);
        const double mean = half.sum / std::max(1.0, half.count);
        const double variance =
            squares / (static_cast<double>(pixels_) * samples_measured) / (mean * mean + kDarkRegularizer);
        // The octave is as long as all before it.
        half.variance = updates_ == 0 ? variance : (half.variance + variance) / 2;
    }
    ++updates_;
}

void AdaptiveBlock::set_shown(int samples) {
    for (Half& half : halves_) {
        if (!half.stopped) half.shown = std::max(half.shown, static_cast<std::uint32_t>(samples));
    }
}

int AdaptiveBlock::shown(std::size_t half) const {
    return samples_of_half(half, static_cast<int>(halves_[half].shown));
}

void AdaptiveBlock::stop_where_enough(int samples, const std::array<double, 2>& mean, double target_error) {
    if (!knows_noise()) return;
    for (std::size_t half = 0; half < halves_.size(); ++half)
        halves_[half].stopped |= samples >= samples_wanted(half, mean, target_error);
}

/// As the other half sees it.
double AdaptiveBlock::samples_wanted(std::size_t half, const std::array<double, 2>& mean, double target_error) const {
    const std::size_t judge = 1 - half;
    return rayuela::samples_wanted(deviation(judge), cost(judge), mean[judge], target_error);
}

void AdaptiveBlock::scale(const std::array<double, 2>& factors) {
    for (std::size_t h = 0; h < halves_.size(); ++h) {
        Half& half = halves_[h];
        const double mean = half.sum / std::max(1.0, half.count), scaled = mean * factors[h];
        half.variance *=
            factors[h] * factors[h] * (mean * mean + kDarkRegularizer) / (scaled * scaled + kDarkRegularizer);
        half.sum *= factors[h];
    }
    for (auto& contrast : contrast_) {
        for (std::size_t h = 0; h < halves_.size(); ++h) contrast[h] *= static_cast<float>(factors[h]);
    }
}

bool AdaptiveBlock::stopped_too_early(const std::array<double, 2>& mean, double target_error) const {
    for (std::size_t half = 0; half < halves_.size(); ++half) {
        if (stopped(half) && halves_[half].shown < samples_wanted(half, mean, target_error)) return true;
    }
    return false;
}

int AdaptiveBlock::resume(int samples) {
    for (Half& half : halves_) half.stopped = false;
    return std::min(samples, static_cast<int>(std::min(halves_[0].shown, halves_[1].shown)));
}

int end_of_half(int sample) {
    if (sample < static_cast<int>(kFirstMeasured)) return kFirstMeasured;
    const int octave = static_cast<int>(std::bit_floor(static_cast<unsigned>(sample)));
    return sample < octave + octave / 2 ? octave + octave / 2 : 2 * octave;
}

int next_decision(int samples) {
    return std::max(AdaptiveBlock::kMinSamples, static_cast<int>(std::bit_floor(static_cast<unsigned>(samples))) * 2);
}

std::array<double, 2> mean_burden(std::span<const AdaptiveBlock* const> blocks) {
    std::array<double, 2> sum{};
    double pixels = 0;
    for (const AdaptiveBlock* block : blocks) {
        if (!block->knows_noise()) continue;
        const auto size = static_cast<double>(block->pixels());
        for (std::size_t half = 0; half < 2; ++half)
            sum[half] += size * block->deviation(half) * std::sqrt(block->cost(half));
        pixels += size;
    }
    return {sum[0] / std::max(1.0, pixels), sum[1] / std::max(1.0, pixels)};
}

double samples_wanted(double deviation, double cost, double mean_burden, double target_error) {
    return deviation / std::sqrt(cost) * mean_burden / (target_error * target_error);
}

}  // namespace rayuela
