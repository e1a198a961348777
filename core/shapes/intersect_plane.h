#pragma once

#include "core/math/precise.h"
#include "core/shapes/shape_hit.h"

namespace rayuela {

/// A plane in double: its transform may be part of it. The normal has any length but zero.
struct PlaneD {
    Vec3d point{0};
    Vec3d normal{0, 1, 0};
};

/// The hit, if it is in `range`. A ray parallel to the plane misses, also when it lies in it.
inline bool intersect_plane(const PlaneD& plane, const RayD& ray, const TRange& range, ShapeHit& hit) {
    const double speed = glm::dot(plane.normal, ray.direction);
    const double distance = glm::dot(plane.normal, plane.point - ray.origin);
    if (speed == 0) return false;
    const float t = static_cast<float>(distance / speed);
    if (!range.contains(t)) return false;
    hit = {.t = t};
    return true;
}

}  // namespace rayuela
