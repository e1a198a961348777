#pragma once

#include "core/accel/surface_point.h"
#include "tests/support/accel_scenes.h"

#include <cmath>
#include <optional>

/// Geometry in long double, against which the kernels are held.
namespace rayuela::test {

using Real = long double;
using Vec3l = glm::vec<3, Real>;

inline constexpr Real kU = 0x1p-24L;  ///< Unit roundoff of float.

inline float log_uniform(Random& random, float lo, float hi) {
    return std::exp(random.uniform(std::log(lo), std::log(hi)));
}

/// A vector of any direction and scale.
inline Vec3 log_uniform_vector(Random& random, float lo, float hi) {
    return random.direction() * log_uniform(random, lo, hi);
}

struct SphereOracle {
    bool near_tangent = false;  ///< Within 2 ulp of float.
    bool on_surface = false;    ///< The origin, so closely that the sign of t is lost in long double.
    std::optional<Real> t;
};

/// The quadratic in long double: the discriminant from the point of closest approach, the roots without cancellation.
inline SphereOracle solve_sphere(const Vec3& center, float radius, const Ray& ray) {
    const Vec3l d(ray.direction), o = Vec3l(ray.origin) - Vec3l(center);
    const Real a = glm::dot(d, d), b = -glm::dot(o, d), r = radius;
    const Vec3l closest = o + (b / a) * d;
    const Real distance = std::sqrt(glm::dot(closest, closest)), c = glm::dot(o, o) - r * r;
    SphereOracle oracle;
    oracle.near_tangent = std::fabs(distance - r) <= 4 * kU * r;
    oracle.on_surface = std::fabs(c) <= 0x1p-60L * r * r;
    if (distance > r) return oracle;
    const Real q = b + std::copysign(std::sqrt(a * (r - distance) * (r + distance)), b);
    Real near = q == 0 ? 0 : c / q, far = q / a;
    if (near > far) std::swap(near, far);
    if (far >= ray.t_min) oracle.t = near >= ray.t_min ? near : far;
    return oracle;
}

/// Distance from `expected` in units in the last place of float at the magnitude of `expected`, or of `floor` below that.
inline double ulp_error(float actual, Real expected, Real floor = 0x1p-126L) {
    const Real magnitude = std::fmax(std::fabs(expected), floor);
    return static_cast<double>(std::fabs(Real(actual) - expected) / std::ldexp(1.0L, std::ilogb(magnitude) - 23));
}

inline SurfacePoint surface_of(const GeometryInstance& instance, const Ray& ray, const Hit& hit) {
    return surface_point({&instance, 1}, ray, hit);
}

}  // namespace rayuela::test
