#include "core/accel/surface_point.h"

#include "core/accel/traced_object.h"
#include "core/math/float_error.h"

#include <limits>
#include <numbers>

namespace rayuela {
namespace {

/// Surface in a space in which it is known exactly to double, before it is rounded to world floats.
struct Surface {
    Vec3d p{0};
    Vec3d ng{0};  ///< Any length, world space.
    Vec3d ns{0};  ///< Zero: as ng.
    Vec2 uv{0};
    double size = 0;  ///< Extent of the numbers that p was made from; its error in double is a fraction of this.
};

/// Takes normals from the shape's space to the world: the inverse transpose up to a positive factor.
class NormalTransform {
public:
    explicit NormalTransform(const AffineD& to_world) {
        const glm::dmat3& m = to_world.linear;
        const double sign = glm::determinant(m) < 0 ? -1 : 1;
        cofactors_ = sign * glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    }
    Vec3d operator()(const Vec3d& n) const { return cofactors_ * n; }

private:
    glm::dmat3 cofactors_;
};

double max_abs(const Vec3d& v) {
    return glm::max(std::fabs(v.x), glm::max(std::fabs(v.y), std::fabs(v.z)));
}

/// How far a point at `p` is kept from the edges of its surface: so far that rounding to float does not take it beyond a
/// wall that meets the surface there, and lets light into a sealed room.
double margin_at(const Vec3d& p) {
    return 3 * double{kUnitRoundoff} * max_abs(p);
}

/// Where a hit on (a, b, c), given in world space, lies: towards the centroid by as much as the margin asks for in a triangle
/// that is not thin.
Surface on_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double b1, double b2) {
    const Vec3d e1 = b - a, e2 = c - a;
    const double extent = glm::max(max_abs(e1), max_abs(e2));
    const double inward = glm::min(1.0, 6 * margin_at(a + b1 * e1 + b2 * e2) / extent);
    Surface surface;
    surface.p = a + glm::mix(b1, 1.0 / 3, inward) * e1 + glm::mix(b2, 1.0 / 3, inward) * e2;
    surface.ng = glm::cross(e1, e2);
    surface.size = max_abs(a) + max_abs(b) + max_abs(c);
    return surface;
}

Surface surface_of(const Sphere& sphere, const GeometryInstance& instance, const Ray& ray, const Hit& hit) {
    const AffineD to_world(instance.to_world);
    const auto baked = world_sphere(sphere, instance.to_world);
    const RayD world(ray);
    const SphereD local = baked ? *baked : SphereD{Vec3d(sphere.center), sphere.radius};
    const RayD local_ray = baked ? world : to_world.inverse().ray(world);
    // Down to the surface from a point close to it: from the centre up, a ground of large radius would lose digits.
    const Vec3d along = local_ray.at(hit.t);
    const double distance = glm::length(along - local.center);
    const Vec3d n = (along - local.center) / distance;
    const double height = squared_distance_excess(along, local.center, local.radius) / (distance + local.radius);
    const Vec3d p = along - height * n;

    Surface surface;
    surface.p = baked ? p : to_world.point(p);
    surface.ng = baked ? n : NormalTransform(to_world)(n);
    surface.size = max_abs(surface.p) + (baked ? 0.0 : max_abs(to_world.translation) + max_abs(to_world.vector(p)));

    const Vec3d own = baked ? glm::transpose(to_world.linear) * n : n;
    const Vec3d unit = glm::normalize(own);
    const double longitude = std::atan2(-unit.z, unit.x) * (0.5 * std::numbers::inv_pi);
    surface.uv = Vec2(static_cast<float>(longitude < 0 ? longitude + 1 : longitude),
                      static_cast<float>(std::acos(glm::clamp(unit.y, -1.0, 1.0)) * std::numbers::inv_pi));
    return surface;
}

Surface surface_of(const Plane& plane, const GeometryInstance& instance, const Ray& ray, const Hit& hit) {
    const PlaneD world = world_plane(plane, instance.to_world);
    const Vec3d n = glm::normalize(world.normal);
    const Vec3d along = RayD(ray).at(hit.t);

    Surface surface;
    surface.p = along - glm::dot(n, along - world.point) * n;
    surface.ng = n;
    surface.size = max_abs(along) + max_abs(world.point);

    const bool in_world = instance.to_world.is_identity();
    const Vec3d own =
        (in_world ? surface.p : AffineD(instance.to_world).inverse().point(surface.p)) - Vec3d(plane.point);
    const Vec3d own_normal = glm::normalize(Vec3d(plane.normal));
    const Vec3d axis = std::fabs(own_normal.y) > 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d s = glm::normalize(axis - glm::dot(axis, own_normal) * own_normal);
    surface.uv = Vec2(glm::dot(own, s), glm::dot(own, glm::cross(own_normal, s)));
    return surface;
}

Surface surface_of(const Box& box, const GeometryInstance& instance, const Ray& ray, const Hit& hit) {
    const AffineD to_world(instance.to_world);
    const auto baked = world_box(box, instance.to_world);
    const Box local = baked ? *baked : box;
    const Vec3d lo(local.min), hi(local.max);
    const RayD world(ray);
    const int axis = static_cast<int>(hit.primitive / 2);
    const bool max_side = hit.primitive % 2 == 1;

    Vec3d p = (baked ? world : to_world.inverse().ray(world)).at(hit.t);
    const double margin = margin_at(world.at(hit.t));
    for (int k = 0; k < 3; ++k) {
        const double scale = baked ? 1.0 : glm::length(to_world.linear[k]);
        const double inward = glm::min(margin / scale, 0.5 * (hi[k] - lo[k]));
        p[k] = glm::clamp(p[k], lo[k] + inward, hi[k] - inward);
    }
    p[axis] = max_side ? hi[axis] : lo[axis];
    Vec3d n(0);
    n[axis] = max_side ? 1 : -1;

    Surface surface;
    surface.p = baked ? p : to_world.point(p);
    surface.ng = baked ? n : NormalTransform(to_world)(n);
    surface.size = max_abs(surface.p) + max_abs(to_world.translation) + max_abs(baked ? p : to_world.vector(p));
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto across = [&](int k) { return hi[k] > lo[k] ? (p[k] - lo[k]) / (hi[k] - lo[k]) : 0.0; };
    surface.uv = Vec2(across(a), across(b));
    return surface;
}

Vec3d keep_front(const Vec3d& n, const Affine& to_world) {
    return glm::determinant(glm::dmat3(to_world.linear)) < 0 ? -n : n;
}

Surface surface_of(const Triangle& triangle, const GeometryInstance& instance, const Ray&, const Hit& hit) {
    const TriangleCorners c = world_triangle(triangle, instance.to_world);
    Surface surface = on_triangle(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2]), hit.u, hit.v);
    surface.ng = keep_front(surface.ng, instance.to_world);
    surface.uv = Vec2(hit.u, hit.v);
    return surface;
}

/// The half that was hit decides the plane: rounded corners need not lie in one.
Surface surface_of(const Quad& quad, const GeometryInstance& instance, const Ray&, const Hit& hit) {
    const QuadCorners c = world_quad(quad, instance.to_world);
    const double u = hit.u, v = hit.v;
    Surface surface = u >= v ? on_triangle(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2]), u - v, v)
                             : on_triangle(Vec3d(c[0]), Vec3d(c[2]), Vec3d(c[3]), u, v - u);
    surface.ng = keep_front(surface.ng, instance.to_world);
    surface.uv = Vec2(hit.u, hit.v);
    return surface;
}

Surface surface_of(const std::shared_ptr<const TriangleMesh>& mesh, const GeometryInstance& instance, const Ray&,
                   const Hit& hit) {
    const AffineD to_world(instance.to_world);
    const glm::uvec3 t = mesh->triangles[hit.primitive];
    const auto position = [&](std::uint32_t i) { return to_world.point(Vec3d(mesh->positions[i])); };
    const double b1 = hit.u, b2 = hit.v, b0 = 1 - b1 - b2;
    Surface surface = on_triangle(position(t.x), position(t.y), position(t.z), b1, b2);
    surface.size += max_abs(to_world.translation);
    surface.ng = keep_front(surface.ng, instance.to_world);
    if (!mesh->normals.empty()) {
        const auto normal = [&](std::uint32_t i) { return Vec3d(mesh->normals[i]); };
        surface.ns = NormalTransform(to_world)(b0 * normal(t.x) + b1 * normal(t.y) + b2 * normal(t.z));
    }
    surface.uv = mesh->uvs.empty()
                     ? Vec2(hit.u, hit.v)
                     : static_cast<float>(b0) * mesh->uvs[t.x] + hit.u * mesh->uvs[t.y] + hit.v * mesh->uvs[t.z];
    return surface;
}

}  // namespace

SurfacePoint surface_point(std::span<const GeometryInstance> instances, const Ray& ray, const Hit& hit) {
    const GeometryInstance& instance = instances[hit.object];
    const Surface surface =
        std::visit([&](const auto& shape) { return surface_of(shape, instance, ray, hit); }, instance.shape);

    SurfacePoint point;
    point.p = Vec3(surface.p);
    // Rounding to float, and the rounding of everything in double before it. The smallest term keeps the bound positive
    // where the surface passes through the origin.
    constexpr double kDoubleError = 0x1p-36;
    constexpr double kSmallest = 0x1p-100;
    point.p_error =
        Vec3(glm::abs(surface.p) * (1.01 * double{kUnitRoundoff}) + (kDoubleError * surface.size + kSmallest));
    point.ng = Vec3(glm::normalize(surface.ng));
    const double ns_length = glm::length(surface.ns);
    point.ns = ns_length > 0 && std::isfinite(ns_length) ? Vec3(surface.ns / ns_length) : point.ng;
    point.uv = surface.uv;
    return point;
}

}  // namespace rayuela
