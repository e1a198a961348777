#pragma once

#include "core/math/vec.h"

#include <algorithm>
#include <cmath>

// Directions and points from numbers u in [0, 1)^2, area-preserving, so that stratified numbers stay stratified.
// Directions are unit, in a local frame around +z. Densities are per solid angle.

namespace rayuela {

/// Polynomials in z = x^2 for |x| <= pi/4, to the last bit but one: sin(x) = x + x z S(z), cos(x) = 1 - z/2 + z^2 C(z).
/// Moshier, Cephes Mathematical Library. Highest power first.
inline constexpr float kSinOctant[] = {-1.9515295891e-4f, 8.3321608736e-3f, -1.6666654611e-1f};
inline constexpr float kCosOctant[] = {2.443315711809948e-5f, -1.388731625493765e-3f, 4.166664568298827e-2f};

/// (cos x, sin x) for |x| <= pi / 4.
inline Vec2 cos_sin_octant(float x) {
    const float z = x * x;
    const float s = (kSinOctant[0] * z + kSinOctant[1]) * z + kSinOctant[2];
    const float c = (kCosOctant[0] * z + kCosOctant[1]) * z + kCosOctant[2];
    return {1 - 0.5f * z + z * z * c, x + x * z * s};
}

/// Uniform on the unit disk. Shirley & Chiu, "A low distortion map between disk and square", 1997.
inline Vec2 sample_concentric_disk(const Vec2& u) {
    const float x = 2 * u.x - 1, y = 2 * u.y - 1;
    const bool horizontal = std::abs(x) > std::abs(y);
    const float r = horizontal ? x : y, across = horizontal ? y : x;
    const Vec2 w = r * cos_sin_octant(r == 0 ? 0.0f : (kPi / 4) * (across / r));
    return horizontal ? w : Vec2(w.y, w.x);
}

/// The z^2 of numbers u at the middle of the outermost of the 2^24 steps that u can take.
inline constexpr float kLowestHemisphereZ2 = 0x1p-23f;

/// Density cos / pi. Malley's method. z > 0: numbers on the very edge of the square count as the middle of their step.
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {
    const Vec2 d = sample_concentric_disk(u);
    return {d.x, d.y, std::sqrt(std::max(kLowestHemisphereZ2, 1 - d.x * d.x - d.y * d.y))};
}

/// (cos, sin) of the angle that is `turns`, in [0, 1], of the full one.
inline Vec2 cos_sin_turns(float turns) {
    const float quarter = std::floor(4 * turns + 0.5f);
    const Vec2 w = cos_sin_octant(2 * kPi * (turns - 0.25f * quarter));
    const int quarters = static_cast<int>(quarter) % 4;
    const Vec2 across = quarters % 2 == 0 ? w : Vec2(-w.y, w.x);
    return quarters < 2 ? across : -across;
}

/// A point of the unit disk on the cap about +z of 1 - cos(half angle) = `one_minus_cos`, in (0, 2], by Lambert's map of equal
/// areas: the rim of the disk is that of the cap. Written so that tiny caps keep their precision.
inline Vec3 disk_to_cap(const Vec2& d, float one_minus_cos) {
    const float x = glm::dot(d, d) * one_minus_cos;
    return Vec3(d * std::sqrt(one_minus_cos * std::max(0.0f, 2 - x)), 1 - x);
}

/// Within the cone about +z of 1 - cos(half angle) = `one_minus_cos`, in (0, 2]: 2 is the sphere, 1 the hemisphere. Not in
/// polar coordinates: strata stay compact.
inline Vec3 sample_uniform_cone(const Vec2& u, float one_minus_cos) {
    return disk_to_cap(sample_concentric_disk(u), one_minus_cos);
}

inline float uniform_cone_pdf(float one_minus_cos) {
    return 1 / (2 * kPi * one_minus_cos);
}

inline Vec3 sample_uniform_hemisphere(const Vec2& u) {
    return sample_uniform_cone(u, 1);
}

inline Vec3 sample_uniform_sphere(const Vec2& u) {
    return sample_uniform_cone(u, 2);
}

inline constexpr float kUniformHemispherePdf = 1 / (2 * kPi);
inline constexpr float kUniformSpherePdf = 1 / (4 * kPi);

/// Barycentrics (b1, b2) of a point uniform over a triangle. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
inline Vec2 sample_uniform_triangle(const Vec2& u) {
    return u.x < u.y ? Vec2(u.x / 2, u.y - u.x / 2) : Vec2(u.x - u.y / 2, u.y / 2);
}

/// The u that `sample_uniform_triangle` maps to these barycentrics.
inline Vec2 invert_uniform_triangle(const Vec2& b) {
    return b.x < b.y ? Vec2(2 * b.x, b.x + b.y) : Vec2(b.x + b.y, 2 * b.y);
}

/// In [0, 1], of a density that is linear from `a` at 0 to `b` at 1, both positive. pbrt-v4 2.3.2.
inline float sample_linear(float u, float a, float b) {
    return std::min(u * (a + b) / (a + std::sqrt(a * a + u * (b * b - a * a))), 1.0f);
}

/// Weight of a strategy of density `a` (one sample each) against another of density `b`. Veach & Guibas 1995.
inline float balance_heuristic(float a, float b) {
    if (a == 0) return 0;
    return 1 / (1 + b / a);
}

/// The same with the squares of the densities; written so that neither overflows.
inline float power_heuristic(float a, float b) {
    if (a == 0) return 0;
    const float ratio = b / a;
    return 1 / (1 + ratio * ratio);
}

}  // namespace rayuela
