#pragma once

#include "core/math/precise.h"
#include "core/shapes/shape_hit.h"

#include <array>
#include <cmath>
#include <utility>

namespace rayuela {

/// a * d - b * c with the right sign always and a relative error below 2^-40: where the plain difference cancels, by Kahan's
/// algorithm (Jeannerod, Louvet & Muller, "Further analysis of Kahan's algorithm", Math. Comp. 82, 2013: 1.5 ulp).
inline double difference_of_products(double a, double d, double b, double c) {
    const double ad = a * d, bc = b * c;
    const double difference = ad - bc;
    if (std::fabs(difference) > 0x1p-12 * (std::fabs(ad) + std::fabs(bc))) return difference;
    return std::fma(a, d, -bc) + std::fma(-b, c, bc);
}

/// A ray prepared for triangles: the shear that takes it to the z axis, with z the ray's dominant axis.
struct TriangleRay {
    Vec3d origin{0};
    double shear_x = 0, shear_y = 0;
    double inverse_z = 1;
    int kx = 0, ky = 1, kz = 2;

    TriangleRay() = default;
    explicit TriangleRay(const RayD& ray) : origin(ray.origin) {
        const Vec3d size = glm::abs(ray.direction);
        kz = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
        kx = kz == 2 ? 0 : kz + 1;
        ky = kx == 2 ? 0 : kx + 1;
        inverse_z = 1 / ray.direction[kz];
        shear_x = ray.direction[kx] * inverse_z;
        shear_y = ray.direction[ky] * inverse_z;
    }
    /// Depends on the ray and the vertex alone, so that triangles which share a vertex agree on it.
    Vec3d sheared(const Vec3& vertex) const {
        const Vec3d v = Vec3d(vertex) - origin;
        return {v[kx] - shear_x * v[kz], v[ky] - shear_y * v[kz], v[kz]};
    }
};

/// The hit, if it is in `range`; u, v are the barycentrics of b and c. Both sides count. Watertight: the test is Woop, Benthin &
/// Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with sheared vertices in double and edge functions of
/// exact sign instead of float with a fallback. t is the one of the point u, v of the triangle, which lies off the ray by less
/// than 2^-38 of the triangle's extent: traversal may rely on it.
inline bool intersect_triangle(const TriangleRay& ray, const Vec3& va, const Vec3& vb, const Vec3& vc,
                               const TRange& range, ShapeHit& hit) {
    const Vec3d a = ray.sheared(va), b = ray.sheared(vb), c = ray.sheared(vc);
    const double u = difference_of_products(c.x, b.y, c.y, b.x);
    const double v = difference_of_products(a.x, c.y, a.y, c.x);
    const double w = difference_of_products(b.x, a.y, b.y, a.x);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    const double determinant = u + v + w;
    if (determinant == 0) return false;

    const double inverse = 1 / determinant;
    const double t = (u * a.z + v * b.z + w * c.z) * inverse * ray.inverse_z;
    if (!range.contains(static_cast<float>(t))) return false;
    hit = triangle_hit(t, v * inverse, w * inverse);
    return true;
}

/// The halves of a quad over one diagonal, as corners: as watertight as triangles are.
inline constexpr std::array<std::array<std::size_t, 3>, 2> kQuadHalves{{{0, 1, 2}, {0, 2, 3}}};

/// Barycentrics of a half to the parameters of its quad, which run along the edges from the first corner to the second and to
/// the fourth.
inline void set_quad_parameters(std::size_t half, ShapeHit& hit) {
    (half == 0 ? hit.u : hit.v) = std::fmin(hit.u + hit.v, 1.0f);
}

/// Corners in turn. The closer half counts, the first where both are as close.
inline bool intersect_quad(const TriangleRay& ray, const std::array<Vec3, 4>& corners, const TRange& range,
                           ShapeHit& hit) {
    bool found = false;
    for (std::size_t half = 0; half < 2; ++half) {
        const auto& [a, b, c] = kQuadHalves[half];
        ShapeHit other;
        if (!intersect_triangle(ray, corners[a], corners[b], corners[c], range, other)) continue;
        set_quad_parameters(half, other);
        if (!found || other.t < hit.t || (other.t == hit.t && other.t_rest < hit.t_rest)) hit = other;
        found = true;
    }
    return found;
}

}  // namespace rayuela
