#pragma once

#include "core/accel/traced_object.h"
#include "core/render/camera_rays.h"

namespace rayuela {

/// The closest hit as the reference finds it: t is not rounded to float.
struct ReferenceHit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t object = kNone, primitive = kNone;  ///< As in Hit.

    bool valid() const { return object != kNone; }
};

/// What the ray through the centre of each pixel (row-major, from the centre of the lens) meets first at t >= 0. Shares
/// nothing with the accelerators but the list of primitives: each is projected to the image, and textbook formulas in double
/// or better test it against the pixels in the rectangle that its projection needs. Nothing when `cancelled` became true.
std::vector<ReferenceHit> reference_trace(std::span<const GeometryInstance> instances, const CameraRays& camera,
                                          const glm::ivec2& size, const std::atomic<bool>& cancelled);

/// t of the first hit at t >= 0 of the ray with one object that is no mesh.
std::optional<double> reference_distance(const TracedObject& object, const RayD& ray);

}  // namespace rayuela
