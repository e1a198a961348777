#pragma once

namespace rayuela {

/// How a session samples, beyond what the scene says. As it is here nothing is left out and nothing changed.
struct SamplingOptions {
    /// Relative error (root of relMSE) at which the image is finished. Samples go where the noise is, see AdaptiveBlock.
    /// 0: all pixels get the same number, without end.
    double target_error = 0;
    /// Samples whose brightest channel exceeds this are darkened to it, in proportion. That loses energy, which is counted.
    /// 0: none is.
    float clamp = 0;

    bool operator==(const SamplingOptions&) const = default;
};

inline constexpr float kMinTargetError = 0.001f, kMaxTargetError = 1;

}  // namespace rayuela
