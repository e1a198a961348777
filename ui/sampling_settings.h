#pragma once

#include "core/render/sampling_options.h"

namespace rayuela {

/// How the window's session samples; no part of the scene. Adaptive sampling and its target are remembered between starts;
/// the clamp, which changes the image, is not.
struct SamplingSettings {
    bool adaptive = true;
    float target_error = 0.02f;
    bool clamps = false;
    float clamp = 10;

    SamplingOptions options() const {
        return {.target_error = adaptive ? static_cast<double>(target_error) : 0, .clamp = clamps ? clamp : 0};
    }
};

}  // namespace rayuela
