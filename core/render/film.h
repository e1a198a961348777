#pragma once

#include "core/math/image.h"
#include "core/render/frame.h"

#include <array>
#include <atomic>
#include <bit>
#include <optional>
#include <vector>

namespace rayuela {

/// Added to the square of the truth where errors are relative, so that dark pixels do not dominate; the usual value.
inline constexpr double kDarkRegularizer = 0.01;

/// Sums of the samples of each pixel, and of what light paths bring to it, in double precision, in two halves (see sample_half). Different pixels may be
/// added to from different threads; the sums of a pixel depend only on the order of its own samples.
class Film {
public:
    Film(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }

    /// Adds sample number `sample` of the pixel, or counts why it is left out.
    void add(std::size_t pixel, std::uint32_t sample, const Color& radiance);
    /// Adds to the pixel a share of what light paths of the round bring, or counts why it is left out. Not to be called from
    /// several threads. What a pixel shows is the mean of its samples plus the mean of the rounds.
    void splat(std::size_t pixel, std::uint32_t round, const Color& radiance);
    /// Counts the round, whose splats have all been added. Rounds are numbered from 0 and come in order.
    void end_round(std::uint32_t round);
    std::uint32_t rounds() const { return rounds_[0] + rounds_[1]; }
    /// Standard deviation of what a round brings to a pixel, over what the pixel shows, as a root of the mean over the pixels
    /// of squares. 0 below two rounds.
    double splat_deviation() const;
    /// Forgets all rounds.
    void clear_splats();

    /// Multiplies all that has been added by a factor a channel. An estimate without bias, times a number, is one of the image
    /// times that number, whatever chance has decided on the way. Squares are scaled as if all samples of a pixel had the
    /// hue of their sum. Rounds a sum once: 2^28 times are needed for what the rounding of a float image is.
    void scale(const Vec3d& factor);

    /// Whether a pixel is the mean of its halves' means instead of the mean of its samples. Where the number of samples in a
    /// half depends on what the other half found, only that is unbiased (see AdaptiveBlock).
    void set_equal_halves(bool equal) { equal_halves_ = equal; }

    /// Forgets the pixel's samples.
    void clear(std::size_t pixel) { pixels_[pixel] = {}; }
    void clear_rejected();

    /// Accepted samples of the pixel.
    std::uint64_t count(std::size_t pixel) const {
        return pixels_[pixel].count[0] + std::uint64_t(pixels_[pixel].count[1]);
    }
    /// Luminance of the sum of the samples of one half.
    double luminance_sum(std::size_t pixel, std::size_t half) const;
    /// What the pixel shows; black where it has no samples.
    Vec3d mean(std::size_t pixel) const;
    /// Estimated variance of the mean's luminance, for independent samples. 0 below two samples.
    double variance_of_mean(std::size_t pixel) const;
    /// The mean of all pixels, alpha 1. Runs on the calling thread's task arena.
    Image image() const;
    /// Estimate of the mean over pixels and channels of (mean - truth)^2 / (truth^2 + 0.01). The halves A and B of nA and
    /// nB samples have the same expectation, so E[(A - B)^2] = s^2 (1/nA + 1/nB); the error of the mean a A + b B, a + b = 1, is
    /// s^2 (a^2 / nA + b^2 / nB), which for a and b as `mean` has them is (A - B)^2 a b: without bias for independent samples. Two limits: stratified
    /// samples, whose halves complement each other, err less than it says; and as truth^2 is taken from the mean, a pixel
    /// with a rare bright sample errs more. 0 while a pixel has an empty half.
    double relative_error() const;

    std::array<std::uint64_t, kRejectionCount> rejected() const;
    std::uint64_t memory_bytes() const { return pixels_.size() * sizeof(Pixel) + splats_.size() * sizeof(Splats); }

private:
    struct alignas(64) Pixel {
        std::array<Vec3d, 2> sum{Vec3d(0), Vec3d(0)};
        double luminance_squared = 0;
        std::array<std::uint32_t, 2> count{};
    };
    struct Splats {
        std::array<Vec3d, 2> sum{Vec3d(0), Vec3d(0)};
        double luminance_squared = 0;
    };
    bool count_rejection(const Color& radiance);
    /// Mean of one half; NaN while it is empty.
    Vec3d half_mean(std::size_t pixel, std::size_t half) const;
    /// Whether the pixel's halves count the same, whatever they hold.
    bool weighs_halves_alike(const Pixel& p) const { return equal_halves_ && p.count[0] > 0 && p.count[1] > 0; }

    int width_, height_;
    bool equal_halves_ = false;
    std::vector<Pixel> pixels_;
    std::vector<Splats> splats_;  ///< Empty before the first round.
    std::array<std::uint32_t, 2> rounds_{};
    std::array<std::atomic<std::uint64_t>, kRejectionCount> rejected_{};
};

/// The half of the film that a sample is added to: of the samples from 2^k to 2^(k+1) the first 2^(k-1) go to one, the
/// others to the other. Whole blocks of a low-discrepancy sequence stay together, so that each half is stratified nearly as
/// well as the whole is; even and odd samples would each be as noisy as independent ones.
constexpr std::uint32_t sample_half(std::uint32_t sample) {
    const int octave = std::bit_width(sample) - 1;
    return octave < 1 ? sample : (sample >> (octave - 1)) & 1;
}

/// Why a sample of this radiance cannot be added, if so.
std::optional<Rejection> rejection(const Color& radiance);

}  // namespace rayuela
