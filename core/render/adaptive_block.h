#pragma once

#include "core/render/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace rayuela {

/// Adaptive sampling of a block of pixels.
///
/// A rule that looks at the samples it is about to show is biased: blocks without a bright sample stop, the others go on
/// until it is diluted (Kirk & Arvo 1991). Here each half of the film (sample_half) is stopped by what the *other* half
/// found, so that how many samples a half shows does not depend on their values: the mean of each half is unbiased, and so
/// is the mean of the two. While one half goes on, the other is traced to judge it but no longer shown.
///
/// Noise is measured and halves are stopped at powers of two, where both hold the same samples of the sequence. How many
/// samples a block gets is Neyman's allocation (1934): proportional to the deviation of its samples over the root of their
/// cost, which brings the mean of the squared errors over the image to the target with the least work.
class AdaptiveBlock {
public:
    /// No half is stopped before this many samples, a power of two.
    static constexpr int kMinSamples = 32;

    AdaptiveBlock() = default;
    explicit AdaptiveBlock(std::size_t pixels) : pixels_(pixels) {}

    /// Forgets everything.
    void restart();
    /// Noise is measured from sample number `samples` on.
    void start_measuring(int samples);
    /// A sample of luminance `y` of pixel number `pixel` of the block. A pixel's samples come in order.
    void measure(std::size_t pixel, std::uint32_t sample, float y);
    /// All measured samples from number `sample` to `end_of_half(sample)` or before took so many rays.
    void add_cost(std::uint32_t sample, std::uint64_t rays);
    /// After `samples`, a power of two: works out the noise from those since the last time.
    void update_noise(int samples);

    std::size_t pixels() const { return pixels_; }
    bool knows_noise() const { return updates_ > 0; }
    /// Standard deviation of a sample over the mean, as one half's samples show it.
    double deviation(std::size_t half) const { return std::sqrt(halves_[half].variance); }
    /// Rays a sample, as one half's samples show it; 1 where nobody has said.
    double cost(std::size_t half) const {
        return halves_[half].rays > 0 ? halves_[half].rays / halves_[half].count : 1;
    }
    /// Whether the sample belongs into the film.
    bool shows(std::uint32_t sample) const {
        const Half& half = halves_[sample_half(sample)];
        return !half.stopped && sample >= half.shown;
    }
    /// Whether it does, from this sample on.
    bool shows_all_from(std::uint32_t sample) const {
        return !stopped(0) && !stopped(1) && sample >= std::max(halves_[0].shown, halves_[1].shown);
    }
    /// All samples below `samples` that `shows` wanted are in the film.
    void set_shown(int samples);
    /// Samples of a pixel that the film shows in this half.
    int shown(std::size_t half) const;

    bool stopped(std::size_t half) const { return halves_[half].stopped; }
    bool stopped() const { return stopped(0) && stopped(1); }
    /// Stops each half that has as many samples as the other one finds it should: `samples` are traced, `mean` is the
    /// image's mean_burden. Does nothing before there is noise to go by.
    void stop_where_enough(int samples, const std::array<double, 2>& mean, double target_error);
    /// All luminances of each half have been multiplied by a factor.
    void scale(const std::array<double, 2>& factors);
    /// Whether a half shows less than `stop_where_enough` would ask for now.
    bool stopped_too_early(const std::array<double, 2>& mean, double target_error) const;
    /// Lets both halves go on; returns the sample to go on with, so that both get all of theirs.
    int resume(int samples);

private:
    double samples_wanted(std::size_t half, const std::array<double, 2>& mean, double target_error) const;

    struct Half {
        bool stopped = false;
        std::uint32_t shown = 0;  ///< Its samples below this number are in the film.
        double variance = 0;      ///< Of a sample's luminance, over the mean squared.
        double sum = 0, count = 0;
        double rays = 0;  ///< Of these `count` samples.
    };

    std::size_t pixels_ = 0;
    int measured_from_ = 0, updates_ = 0;
    std::array<Half, 2> halves_;
    /// Of each pixel and half: the sum of the first part of the octave's samples less that of the second.
    std::vector<std::array<float, 2>> contrast_;
};

/// The first sample after `sample` that belongs to another half; of those that are not measured, the first that is.
int end_of_half(int sample);

/// The next number of samples at which blocks may be stopped.
int next_decision(int samples);

/// Mean over the image's pixels of deviation * sqrt(cost), for each half; of the blocks that know it.
std::array<double, 2> mean_burden(std::span<const AdaptiveBlock* const> blocks);

/// Samples a pixel that a block should have.
double samples_wanted(double deviation, double cost, double mean_burden, double target_error);

}  // namespace rayuela
