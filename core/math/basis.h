#pragma once

#include "core/math/vec.h"

#include <cmath>

namespace rayuela {

/// Right-handed orthonormal basis around a unit normal. Local space has the normal along +z.
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Basis {
    Vec3 s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};

    Basis() = default;
    explicit Basis(const Vec3& normal) : n(normal) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        s = Vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
        t = Vec3(b, sign + n.y * n.y * a, -n.y);
    }

    Vec3 to_local(const Vec3& w) const { return {glm::dot(w, s), glm::dot(w, t), glm::dot(w, n)}; }
    Vec3 to_world(const Vec3& l) const { return l.x * s + l.y * t + l.z * n; }
};

}  // namespace rayuela
