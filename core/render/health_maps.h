#pragma once

#include "core/render/frame.h"
#include "core/render/reference_trace.h"
#include "core/render/render_scene.h"

namespace rayuela {

/// Maps of how well sampling and arithmetic do in a view: a number for each pixel, row-major from the upper left. Those of camera
/// rays take the ray through the pixel's centre and the centre of the lens; NaN where it meets nothing. They are empty when
/// `cancelled` became true on the way.

/// Samples that have been traced for each pixel: `elsewhere` where no block says.
std::vector<float> sample_map(std::span<const SampledBlock> blocks, int elsewhere, const glm::ivec2& size);

/// Samples of each pixel that the film has rejected.
std::vector<float> rejected_map(std::span<const RejectedPixel> pixels, const glm::ivec2& size);

/// Length of the error bound on the hit point over its distance from the camera.
std::vector<float> position_error_map(const RenderScene& scene, const glm::ivec2& size,
                                      const std::atomic<bool>& cancelled);

/// What `retrace_map` says of one ray.
float disagreement(const Hit& hit, const ReferenceHit& reference);

/// |t - reference t| / reference t, where t is what the scene's accelerator finds and the reference that of `reference_trace`.
/// Infinite where one finds something and the other nothing, or another primitive at another distance; primitives that lie
/// at the same distance, to the rounding of float, are told apart by a rule and not by arithmetic.
std::vector<float> retrace_map(const RenderScene& scene, const glm::ivec2& size, const std::atomic<bool>& cancelled);

}  // namespace rayuela
