#pragma once

#include "core/math/ray.h"

namespace rayuela {

/// Closed axis-aligned box. Default constructed it is empty (lo > hi) and the identity of `extend`.
struct Bounds3 {
    Vec3 lo{kInfinity};
    Vec3 hi{-kInfinity};

    bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
    Vec3 extent() const { return empty() ? Vec3(0) : hi - lo; }
    Vec3 center() const { return 0.5f * lo + 0.5f * hi; }
    float surface_area() const {
        const Vec3 e = extent();
        return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
    }
    int longest_axis() const {
        const Vec3 e = extent();
        return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    }
    void extend(const Vec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    void extend(const Bounds3& b) {
        lo = glm::min(lo, b.lo);
        hi = glm::max(hi, b.hi);
    }
    bool contains(const Vec3& p) const {
        return glm::all(glm::lessThanEqual(lo, p)) && glm::all(glm::lessThanEqual(p, hi));
    }
};

}  // namespace rayuela
