#pragma once

#include "core/accel/flat_points.h"
#include "core/accel/surface_rounding.h"
#include "core/accel/traced_object.h"

#include <cmath>
#include <memory>
#include <numbers>

namespace rayuela {

/// Surface in a space in which it is known exactly to double, before it is rounded to world floats.
struct Surface {
    Vec3d p{0};
    double size = 0;  ///< Extent of the numbers that p was made from; its error in double is a fraction of this.
    Vec3 ng{0};
    Vec2 uv{0};
};

inline double max_abs(const Vec3d& v) {
    return glm::max(std::fabs(v.x), glm::max(std::fabs(v.y), std::fabs(v.z)));
}

inline Vec3 unit(const Vec3d& v) {
    return Vec3(glm::normalize(v));
}

inline double margin_at(const Vec3d& p) {
    return kEdgeMargin * max_abs(p);
}

/// The way from a shape's own space to the world and back. A shape that has been taken to the world once and for all needs
/// none, unless texture coordinates follow from what it was before.
class Placement {
public:
    Placement(const Affine& to_world, bool shape_in_world, bool keeps_way = false)
        : in_world_(shape_in_world),
          way_(!shape_in_world || keeps_way ? std::make_unique<const Way>(AffineD(to_world)) : nullptr) {}

    bool in_world() const { return in_world_; }
    /// The rest, but for what a shape in the world does without.
    bool has_way() const { return way_ != nullptr; }
    static constexpr std::size_t way_bytes() { return sizeof(Way); }
    const AffineD& to_world() const { return way_->to_world; }
    const AffineD& to_local() const { return way_->to_local; }
    RayD ray(const Ray& world) const { return in_world_ ? RayD(world) : to_local().ray(RayD(world)); }
    Vec3d point(const Vec3d& p) const { return in_world_ ? p : to_world().point(p); }
    Vec3d normal(const Vec3d& n) const { return in_world_ ? n : way_->normals * n; }

private:
    struct Way {
        AffineD to_world, to_local;
        glm::dmat3 normals;  ///< The inverse transpose of to_world, up to a positive factor.

        explicit Way(const AffineD& affine) : to_world(affine), to_local(affine.inverse()) {
            const glm::dmat3& m = affine.linear;
            normals = glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
            if (glm::determinant(m) < 0) normals = -normals;
        }
    };

    bool in_world_;
    std::unique_ptr<const Way> way_;
};

/// A shape ready to tell the surface where it was hit. Specialised for each alternative of TracedShape.
template <typename Shape>
struct SurfaceOf;

template <>
struct SurfaceOf<Sphere> {
    Placement placement;
    SphereD sphere;

    SurfaceOf(const Sphere& own, const Affine& to_world, bool with_uv)
        : placement(to_world, world_sphere(own, to_world).has_value(), with_uv),
          sphere(world_sphere(own, to_world).value_or(SphereD{Vec3d(own.center), own.radius})) {}

    Surface at(const Ray& ray, const Hit& hit, bool with_uv) const {
        // Down to the surface from a point close to it: from the centre up, a ground of large radius would lose digits.
        const Vec3d along = placement.ray(ray).at(hit.t);
        const double distance = glm::length(along - sphere.center);
        const Vec3d n = (along - sphere.center) / distance;
        const double height = squared_distance_excess(along, sphere.center, sphere.radius) / (distance + sphere.radius);
        const Vec3d p = along - height * n;

        Surface surface;
        surface.p = placement.point(p);
        surface.ng = unit(placement.normal(n));
        surface.size = max_abs(surface.p);
        if (!placement.in_world())
            surface.size += max_abs(placement.to_world().translation) + max_abs(placement.to_world().vector(p));
        if (with_uv && placement.has_way()) surface.uv = uv(n);
        return surface;
    }

    Vec2 uv(const Vec3d& n) const {
        const Vec3d own = glm::normalize(placement.in_world() ? glm::transpose(placement.to_world().linear) * n : n);
        const double longitude = std::atan2(-own.z, own.x) * (0.5 * std::numbers::inv_pi);
        const double polar = std::acos(glm::clamp(own.y, -1.0, 1.0)) * std::numbers::inv_pi;
        return Vec2(longitude < 0 ? longitude + 1 : longitude, polar);
    }
};

template <>
struct SurfaceOf<Plane> {
    Placement placement;
    PlaneD plane;  ///< Unit normal.
    Vec3d own_point, s, t;

    SurfaceOf(const Plane& own, const Affine& to_world)
        : placement(to_world, to_world.is_identity()), plane(world_plane(own, to_world)), own_point(own.point) {
        plane.normal = glm::normalize(plane.normal);
        const Vec3d normal = glm::normalize(Vec3d(own.normal));
        const Vec3d axis = std::fabs(normal.y) > 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        s = glm::normalize(axis - glm::dot(axis, normal) * normal);
        t = glm::cross(normal, s);
    }

    Surface at(const Ray& ray, const Hit& hit, bool) const {
        const Vec3d along = RayD(ray).at(hit.t);
        Surface surface;
        surface.p = along - glm::dot(plane.normal, along - plane.point) * plane.normal;
        surface.ng = Vec3(plane.normal);
        surface.size = max_abs(along) + max_abs(plane.point);
        const Vec3d own = (placement.in_world() ? surface.p : placement.to_local().point(surface.p)) - own_point;
        surface.uv = Vec2(glm::dot(own, s), glm::dot(own, t));
        return surface;
    }
};

template <>
struct SurfaceOf<Box> {
    Placement placement;
    Vec3d lo, hi;
    Vec3d scale{1};  ///< A step along an axis of the box is so long in the world.
    double offset;   ///< Largest of the numbers by which the box has been moved.

    SurfaceOf(const Box& own, const Affine& to_world)
        : placement(to_world, world_box(own, to_world).has_value()), offset(max_abs(Vec3d(to_world.translation))) {
        const Box box = world_box(own, to_world).value_or(own);
        lo = Vec3d(box.min);
        hi = Vec3d(box.max);
        if (placement.in_world()) return;
        for (int axis = 0; axis < 3; ++axis) scale[axis] = glm::length(placement.to_world().linear[axis]);
    }

    Surface at(const Ray& ray, const Hit& hit, bool) const {
        const int axis = static_cast<int>(hit.primitive / 2);
        const bool max_side = hit.primitive % 2 == 1;
        Vec3d p = placement.ray(ray).at(hit.t);
        const double margin = margin_at(RayD(ray).at(hit.t));
        for (int k = 0; k < 3; ++k) {
            const double inward = glm::min(margin / scale[k], 0.5 * (hi[k] - lo[k]));
            p[k] = glm::clamp(p[k], lo[k] + inward, hi[k] - inward);
        }
        p[axis] = max_side ? hi[axis] : lo[axis];
        Vec3d n(0);
        n[axis] = max_side ? 1 : -1;

        Surface surface;
        surface.p = placement.point(p);
        surface.ng = unit(placement.normal(n));
        surface.size = max_abs(surface.p) + offset + max_abs(placement.in_world() ? p : placement.to_world().vector(p));
        const auto across = [&](int k) { return hi[k] > lo[k] ? (p[k] - lo[k]) / (hi[k] - lo[k]) : 0.0; };
        surface.uv = Vec2(across((axis + 1) % 3), across((axis + 2) % 3));
        return surface;
    }
};

/// Corners are taken to the world, and a transform that mirrors turns them round.
inline double front_sign(const Affine& to_world) {
    return glm::determinant(glm::dmat3(to_world.linear)) < 0 ? -1 : 1;
}

/// A triangle of these corners, hit at b1, b2.
inline FlatHit flat_hit(const Vec3& a, const Vec3& b, const Vec3& c, double b1, double b2, double sign) {
    return {.a = Vec3d(a), .b = Vec3d(b), .c = Vec3d(c), .b1 = b1, .b2 = b2, .sign = sign};
}

/// Moved from the edges towards the centroid.
inline Surface flat_surface(const FlatHit& hit) {
    const Vec3d e1 = hit.b - hit.a, e2 = hit.c - hit.a;
    const double margin = margin_at(hit.a + hit.b1 * e1 + hit.b2 * e2);
    const double inward = glm::min(1.0, kTriangleMargins * margin / glm::max(max_abs(e1), max_abs(e2)));
    return {.p = hit.a + glm::mix(hit.b1, 1.0 / 3, inward) * e1 + glm::mix(hit.b2, 1.0 / 3, inward) * e2,
            .size = max_abs(hit.a) + max_abs(hit.b) + max_abs(hit.c) + hit.offset,
            .ng = unit(hit.sign * glm::cross(e1, e2))};
}

// Surfaces of triangles have `flat`, from which a point follows, and say the rest once it is there.

template <>
struct SurfaceOf<Triangle> {
    TriangleCorners corners;
    double sign;

    SurfaceOf(const Triangle& own, const Affine& to_world)
        : corners(world_triangle(own, to_world)), sign(front_sign(to_world)) {}

    FlatHit flat(const Hit& hit) const { return flat_hit(corners[0], corners[1], corners[2], hit.u, hit.v, sign); }
    Vec3 shading_normal(const Hit&) const { return Vec3(0); }
    Vec2 uv(const Hit& hit) const { return {hit.u, hit.v}; }
};

/// The half that was hit decides the plane: rounded corners need not lie in one.
template <>
struct SurfaceOf<Quad> {
    QuadCorners corners;
    double sign;

    SurfaceOf(const Quad& own, const Affine& to_world)
        : corners(world_quad(own, to_world)), sign(front_sign(to_world)) {}

    FlatHit flat(const Hit& hit) const {
        const double u = hit.u, v = hit.v;
        const bool first = u >= v;
        // Without a branch, which nobody could foretell. What is multiplied by 0 or 1 stays exact.
        const double in_first = first ? 1 : 0;
        const std::size_t second = 2 - std::size_t{first};
        return flat_hit(corners[0], corners[second], corners[second + 1], u - in_first * v, v - (1 - in_first) * u,
                        sign);
    }
    Vec3 shading_normal(const Hit&) const { return Vec3(0); }
    Vec2 uv(const Hit& hit) const { return {hit.u, hit.v}; }
};

template <>
struct SurfaceOf<std::shared_ptr<const TriangleMesh>> {
    Placement placement;
    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const std::vector<Vec2>> uvs;  ///< Null where it has none or nobody asks for them.
    double sign, offset;

    SurfaceOf(std::shared_ptr<const TriangleMesh> own, const Affine& to_world, bool with_uv)
        : placement(to_world, to_world.is_identity()),
          mesh(std::move(own)),
          uvs(with_uv ? uvs_of(mesh) : nullptr),
          sign(front_sign(to_world)),
          offset(max_abs(Vec3d(to_world.translation))) {}

    FlatHit flat(const Hit& hit) const {
        const glm::uvec3& t = mesh->triangles[hit.primitive];
        const auto corner = [&](std::uint32_t i) { return placement.point(Vec3d(mesh->positions[i])); };
        return {corner(t.x), corner(t.y), corner(t.z), hit.u, hit.v, sign, offset};
    }
    /// Zero where there is none, or the interpolated normal has no direction.
    Vec3 shading_normal(const Hit& hit) const {
        if (mesh->normals.empty()) return Vec3(0);
        const glm::uvec3& t = mesh->triangles[hit.primitive];
        const double b1 = hit.u, b2 = hit.v;
        const auto normal = [&](std::uint32_t i) { return Vec3d(mesh->normals[i]); };
        const Vec3d n = placement.normal((1 - b1 - b2) * normal(t.x) + b1 * normal(t.y) + b2 * normal(t.z));
        const double length = glm::length(n);
        return length > 0 && std::isfinite(length) ? Vec3(n / length) : Vec3(0);
    }
    Vec2 uv(const Hit& hit) const {
        if (!uvs) return {hit.u, hit.v};
        const glm::uvec3& t = mesh->triangles[hit.primitive];
        const auto b0 = static_cast<float>(1 - double{hit.u} - double{hit.v});
        return b0 * (*uvs)[t.x] + hit.u * (*uvs)[t.y] + hit.v * (*uvs)[t.z];
    }
};

}  // namespace rayuela
