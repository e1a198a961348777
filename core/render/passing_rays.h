#pragma once

#include "core/accel/accelerator.h"
#include "core/render/camera_rays.h"

namespace rayuela {

/// Camera rays that pass the bounds of all objects by: nobody needs to trace them.
class PassingRays {
public:
    PassingRays(const Accelerator& accelerator, const CameraRays& camera);

    /// Whether there are any. Not where a plane has no bounds, nor where the bounds fill the image.
    bool possible() const { return possible_; }
    /// passes[i] becomes 1 for rays that pass, none of which `Accelerator::intersect` finds a hit of, and 0 for all others.
    /// Their t_min is 0 or more.
    void find(std::span<const Ray> rays, std::span<std::uint8_t> passes) const;
    /// The same of one.
    bool passes(const Ray& ray) const;

private:
    Bounds3 bounds_;
    double reach_ = 0;  ///< Largest coordinate of the bounds.
    bool possible_ = false;
};

}  // namespace rayuela
