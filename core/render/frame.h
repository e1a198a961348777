#pragma once

#include "core/accel/accelerator.h"
#include "core/math/image.h"
#include "core/render/shortcuts.h"
#include "core/scene/scene.h"

#include <array>
#include <memory>

namespace rayuela {

class RenderScene;

/// Why a sample was left out of the film.
enum class Rejection : std::uint8_t { nan, infinite, negative };
inline constexpr std::size_t kRejectionCount = 3;

enum class SessionPhase : std::uint8_t {
    idle,       ///< No scene yet.
    building,   ///< Trees are being built.
    rendering,  ///< Samples are being added.
    paused,     ///< On request.
    finished,   ///< The sample or time limit of the scene, or the target error, has been reached.
};

/// How many samples pixels have got.
struct SampleSpread {
    double mean = 0;             ///< Samples traced a pixel.
    double finished_pixels = 0;  ///< Share of the pixels that get no more: they are as the target error asks.
    /// Samples that finished pixels would have got if they had gone on with the others.
    std::uint64_t saved = 0;
};

/// What the clamp has taken from an image.
struct ClampLoss {
    double removed = 0;  ///< Mean over the pixels of the luminance that is missing.
    double share = 0;    ///< Of that in the mean luminance of the unclamped image.
};

/// What a session has done since accumulation last restarted (counters) or for the current scene (trees).
struct RenderStatistics {
    SessionPhase phase = SessionPhase::idle;
    int spp = 0;                    ///< Samples in every pixel that is not finished (see SampleSpread).
    std::uint64_t samples = 0;      ///< Camera paths.
    std::uint64_t rays = 0;         ///< Closest-hit rays.
    std::uint64_t shadow_rays = 0;  ///< Any-hit rays.
    /// As in RayCounts.
    std::uint64_t lamp_paths = 0, environment_lookups = 0, textured_hits = 0, passing_rays = 0;
    std::array<std::uint64_t, kRejectionCount> rejected{};
    double render_seconds = 0;  ///< Wall time in passes, pauses left out.
    double samples_per_second = 0;
    double rays_per_second = 0;  ///< Both kinds.
    double estimated_error = 0;  ///< Estimated relMSE of the image from its two halves; 0 while unknown.
    double build_seconds = 0;    ///< Wall time of the last update of the render scene that built trees.
    AccelStats accel;
    std::uint64_t memory_bytes = 0;  ///< Trees, meshes, images and film.
    std::uint64_t restarts = 0;      ///< How often accumulation has started anew since the session began.
    std::uint64_t relit = 0;         ///< How often what was there has been scaled to other light since.
    Shortcuts shortcuts;             ///< Those in use.
    int threads = 0;
    bool adaptive = false;  ///< Samples go where the noise is.
    SampleSpread spread;
    ClampLoss clamp_loss;
};

/// Pixels of a rectangle for which the same number of samples has been traced.
struct SampledBlock {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< x1 and y1 are the first column and row outside.
    int samples = 0;

    bool operator==(const SampledBlock&) const = default;
};

/// A pixel that lacks samples because their value made no sense.
struct RejectedPixel {
    std::uint32_t pixel = 0;  ///< Row-major from the upper left.
    std::uint32_t samples = 0;

    bool operator==(const RejectedPixel&) const = default;
};

/// A published image: immutable, complete, and shared with whoever looks at it.
struct Frame {
    std::uint64_t version = 0;  ///< Grows with every publication of a session.
    Image image;                ///< Mean radiance, linear; alpha is 1. Smaller than the film while coarse.
    bool coarse = false;        ///< A preview of reduced resolution; its pixels never enter the film.
    /// First object met by the first sample of each pixel, as ObjectId::value (0: none). Size of the image.
    std::vector<std::uint32_t> object_ids;
    std::vector<RejectedPixel> rejected_pixels;       ///< Ascending; none while coarse. Light paths are not among them.
    std::vector<SampledBlock> sampled_blocks;         ///< Empty where all pixels have statistics.spp samples.
    std::shared_ptr<const Scene> scene;               ///< What it shows.
    std::shared_ptr<const RenderScene> render_scene;  ///< To pick in.
    RenderStatistics statistics;
};

}  // namespace rayuela
