#pragma once

#include "core/math/image.h"
#include "core/render/frame.h"

#include <array>
#include <atomic>
#include <bit>
#include <optional>
#include <vector>

namespace rayuela {

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
    /// Forgets all rounds.
    void clear_splats();

    /// Forgets the pixel's samples.
    void clear(std::size_t pixel) { pixels_[pixel] = {}; }
    void clear_rejected();

    /// Accepted samples of the pixel.
    std::uint64_t count(std::size_t pixel) const {
        return pixels_[pixel].count[0] + std::uint64_t(pixels_[pixel].count[1]);
    }
    /// Mean of the accepted samples; black where there are none.
    Vec3d mean(std::size_t pixel) const;
    /// Estimated variance of the mean's luminance: sample variance / count. 0 below two samples.
    double variance_of_mean(std::size_t pixel) const;
    /// The mean of all pixels, alpha 1. Runs on the calling thread's task arena.
    Image image() const;
    /// Estimate of the mean over pixels and channels of (mean - truth)^2 / (truth^2 + 0.01). The halves A and B of nA and
    /// nB samples have the same expectation, so E[(A - B)^2] = s^2 (1/nA + 1/nB) and the mean's error, s^2 / (nA + nB), is
    /// expected to be (A - B)^2 nA nB / (nA + nB)^2: without bias for independent samples. Two limits: stratified
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

    int width_, height_;
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
