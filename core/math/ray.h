#pragma once

#include "core/math/vec.h"

#include <limits>

namespace rayuela {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// Half-line origin + t * direction for t in [t_min, t_max]. The direction need not be unit length.
struct Ray {
    Vec3 origin{0};
    float t_min = 0;
    Vec3 direction{0, 0, 1};
    float t_max = kInfinity;

    Vec3 at(float t) const { return origin + t * direction; }
};

/// The closest intersection, and nothing else: everything a shader needs is derived from it once (SurfaceInteraction).
struct Hit {
    float t = kInfinity;              ///< Parameter along the ray.
    float u = 0, v = 0;               ///< Parametric coordinates on the primitive (barycentrics b1, b2 of a triangle).
    std::uint32_t object = kNone;     ///< Index into the traced objects (GeometryInstance) or kNone.
    std::uint32_t primitive = kNone;  ///< Triangle of a mesh, face of a box, otherwise 0.
    float t_rest = 0;                 ///< What rounding t left out, for triangles; 0 for all others.

    bool valid() const { return object != kNone; }
};

/// The order in which two hits at the same t are told apart, so that no structure changes the image. Where a ray meets both
/// sides of a mesh's edge the exact t counts: the far side faces the other way, and light would leak through it. Objects that
/// lie in each other keep one order everywhere instead.
inline bool is_closer(const Hit& a, const Hit& b) {
    if (a.t != b.t) return a.t < b.t;
    if (a.object != b.object) return a.object < b.object;
    if (a.t_rest != b.t_rest) return a.t_rest < b.t_rest;
    return a.primitive < b.primitive;
}

}  // namespace rayuela
