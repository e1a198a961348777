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
    /// Only of rays that `Accelerator::intersect` finds no hit of. The ray's t_min is 0 or more.
    bool passes(const Ray& ray) const;

private:
    Bounds3 bounds_;
    double reach_ = 0;  ///< Largest coordinate of the bounds.
    bool possible_ = false;
};

}  // namespace rayuela
