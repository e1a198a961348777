#pragma once

#include "core/math/result.h"
#include "core/math/statistics.h"
#include "core/render/skips.h"
#include "core/scene/scene.h"

namespace rayuela {

struct SkipGainOptions {
    int side = 192;        ///< Pixels of the longer side of the image, at most.
    int samples = 4;       ///< A pixel.
    int repetitions = 15;  ///< Rounds, interleaved.
};

/// What one shortcut saves of the time of a scene's render.
struct SkipGain {
    const ShortcutField* shortcut;
    std::string_view skip;  ///< Skip::name.
    Measured ratio;         ///< CPU time with the work put back over the time without it, of the same rounds.
};

/// The scene at most `side` pixels wide and high.
Scene shrunk(Scene scene, int side);

/// The gain of each shortcut that the scene lets the renderer take, on one thread; trees are not part of the time. An error
/// where an image is not the same to the last bit.
Result<std::vector<SkipGain>> measure_skips(const Scene& scene, const SkipGainOptions& options);

}  // namespace rayuela
