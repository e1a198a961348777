#pragma once

#include "core/materials/value.h"
#include "core/math/sampling.h"
#include "core/math/vec.h"

#include <cmath>

namespace rayuela {

/// Narrower lobes than this alpha are finer than what directions in float can tell apart: they are deltas.
inline constexpr float kSmoothAlpha = 1e-4f;

/// `x` brought into [0, 1]; NaN becomes 0.
inline float clamp_unit(float x) {
    return std::fmin(std::fmax(x, 0.0f), 1.0f);
}
inline Color clamp_unit(const Color& c) {
    return {clamp_unit(c.x), clamp_unit(c.y), clamp_unit(c.z)};
}

/// Isotropic GGX distribution of microfacet normals (Walter et al. 2007) around +z. Directions have z > 0.
struct Ggx {
    float alpha = 1;  ///< In (0, 1].

    bool is_smooth() const { return alpha < kSmoothAlpha; }

    /// Density of normals m, so that the integral of d(m) m.z over the hemisphere is 1.
    float d(const Vec3& m) const {
        const float a2 = alpha * alpha;
        const float k = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
        return a2 / (kPi * k * k);
    }

    /// cos(w) sqrt(1 + alpha^2 tan^2(w)), from which Smith's masking follows without dividing by a cosine.
    float root(const Vec3& w) const { return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }

    /// Smith's masking: the share of the facets of a direction that it sees.
    float g1(const Vec3& w) const { return 2 * w.z / (w.z + root(w)); }

    /// Height-correlated masking and shadowing over the masking of wo: G2(wo, wi) / G1(wo). Heitz 2014, eq. 99.
    float g2_over_g1(const Vec3& wo, const Vec3& wi) const {
        const float root_o = root(wo);
        return wi.z * (wo.z + root_o) / (wo.z * root(wi) + wi.z * root_o);
    }

    /// Density per solid angle of m among the normals that wo sees.
    float visible_pdf(const Vec3& wo, const Vec3& m) const {
        return 2 * d(m) * std::fmax(glm::dot(wo, m), 0.0f) / (wo.z + root(wo));
    }

    /// The same for the direction that wo is mirrored into by m: visible_pdf / (4 wo.m).
    float reflection_pdf(const Vec3& wo, const Vec3& m) const { return d(m) / (2 * (wo.z + root(wo))); }

    /// A normal that wo sees, by a spherical cap. Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
    Vec3 sample_visible(const Vec3& wo, const Vec2& u) const {
        const Vec3 stretched = glm::normalize(Vec3(alpha * wo.x, alpha * wo.y, wo.z));
        const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
        const float sine = std::sqrt(std::fmax(1 - z * z, 0.0f));
        const Vec3 h = Vec3(sine * cos_sin_turns(u.x), z) + stretched;
        return glm::normalize(Vec3(alpha * h.x, alpha * h.y, std::fmax(h.z, 0.0f)));
    }
};

inline float alpha_of(float roughness) {
    const float r = clamp_unit(roughness);
    return r * r;
}

/// Whether a surface of this roughness is smooth everywhere.
inline bool is_smooth_everywhere(const FloatValue& roughness) {
    return alpha_of(roughness.value) < kSmoothAlpha && (!roughness.texture || roughness.value == 0);
}

/// `w`, unit but for its rounding to float, with unit length in double: one step of Newton's method for 1 / sqrt(w.w).
inline Vec3d renormalize(const Vec3& w) {
    const Vec3d d(w);
    return d * (1.5 - 0.5 * glm::dot(d, d));
}

/// The normal that mirrors one of these directions into the other. Along the surface two directions nearly cancel: what
/// their rounding to float leaves there is taken out by giving them unit length in double.
inline Vec3 half_vector(const Vec3& wo, const Vec3& wi) {
    return glm::normalize(Vec3(renormalize(wo) + renormalize(wi)));
}

/// `w` mirrored by the unit normal m.
inline Vec3 reflect(const Vec3& w, const Vec3& m) {
    return 2 * glm::dot(w, m) * m - w;
}

/// Mirrored into z > 0 where it lies below.
inline Vec3 upper(const Vec3& w) {
    return w.z < 0 ? Vec3(w.x, w.y, -w.z) : w;
}

}  // namespace rayuela
