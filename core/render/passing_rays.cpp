#include "core/render/passing_rays.h"

#include "core/math/float_error.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// Of origin and bounds: more than the 10 roundings by which trees pass their bounds early and late, see RayBlock.
constexpr double kTolerance = 16 * double{kUnitRoundoff};

bool is_plane(const GeometryInstance& instance) {
    return std::holds_alternative<Plane>(instance.shape);
}

}  // namespace

PassingRays::PassingRays(const Accelerator& accelerator, const CameraRays& camera) : bounds_(accelerator.bounds()) {
    if (std::ranges::any_of(accelerator.instances(), is_plane)) return;
    if (!bounds_.empty()) reach_ = double{max_component(glm::max(glm::abs(bounds_.lo), glm::abs(bounds_.hi)))};
    // As the bounds are convex, the view is within them where its corners are.
    const Vec2 corners[] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    possible_ = std::ranges::any_of(corners, [&](const Vec2& corner) { return passes(camera.ray(corner, Vec2(0))); });
}

bool PassingRays::passes(const Ray& ray) const {
    if (bounds_.empty()) return true;
    const double margin = kTolerance * (reach_ + double{max_component(glm::abs(ray.origin))});
    double enter = 0, leave = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = ray.origin[axis], inverse = 1 / double{ray.direction[axis]};
        const double a = (bounds_.lo[axis] - margin - origin) * inverse;
        const double b = (bounds_.hi[axis] + margin - origin) * inverse;
        // Comparisons leave out a NaN, of a ray along the face.
        const double near = std::min(a, b), far = std::max(a, b);
        if (near > enter) enter = near;
        if (far < leave) leave = far;
    }
    return enter > leave;
}

}  // namespace rayuela
