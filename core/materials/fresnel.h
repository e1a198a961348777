#pragma once

#include "core/math/vec.h"

#include <cmath>

namespace rayuela {

/// Share of unpolarized light that a boundary reflects. `cos_i` in [0, 1] is the cosine of incidence, `eta` > 0 the index
/// of the other side relative to this one; 1 at total reflection. Fresnel's equations in a form without cancellation:
/// with g = eta cos_t = sqrt(eta^2 - sin_i^2),
///     r_s = -(eta^2 - 1) / (cos_i + g)^2,   r_p = (eta^2 - 1) (eta^2 cos_i^2 - sin_i^2) / (eta^2 cos_i + g)^2.
/// In double: close to total reflection g is a difference of almost equal numbers.
inline double fresnel_dielectric(double cos_i, double eta) {
    const double eta2 = eta * eta;
    const double k = (eta - 1) * (eta + 1);
    const double sin2_i = (1 - cos_i) * (1 + cos_i);
    const double g2 = eta2 - sin2_i;
    if (!(g2 > 0)) return k == 0 ? 0.0 : 1.0;
    const double g = std::sqrt(g2);
    const double s = cos_i + g, p = eta2 * cos_i + g;
    const double r_s = k / (s * s), r_p = k * (eta2 * cos_i * cos_i - sin2_i) / (p * p);
    return std::fmin(0.5 * (r_s * r_s + r_p * r_p), 1.0);
}

/// Reflectance at normal incidence.
inline float fresnel_normal(float eta) {
    const float r = (eta - 1) / (eta + 1);
    return r * r;
}

/// (1 - cos)^5: Schlick's weight of grazing reflection, R = f0 + (1 - f0) weight.
inline float schlick_weight(float cos_i) {
    const float m = 1 - cos_i;
    return (m * m) * (m * m) * m;
}

}  // namespace rayuela
