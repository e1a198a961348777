#include "core/accel/traced_object.h"

#include "core/math/float_error.h"

namespace rayuela {
namespace {

template <typename... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <typename... F>
Overloaded(F...) -> Overloaded<F...>;

Bounds3 bounds_of(std::span<const Vec3> points) {
    Bounds3 bounds;
    for (const Vec3& p : points) bounds.extend(p);
    return bounds;
}

Bounds3 bounds_of(const SphereD& sphere, const glm::dmat3& linear, const Vec3d& center) {
    Vec3d reach(0);
    for (int axis = 0; axis < 3; ++axis) {
        reach[axis] = sphere.radius * glm::length(Vec3d(linear[0][axis], linear[1][axis], linear[2][axis]));
    }
    return round_outward(center - reach, center + reach);
}

Bounds3 transformed(const Bounds3& box, const AffineD& affine) {
    if (box.empty()) return box;
    const Vec3d half = 0.5 * (Vec3d(box.hi) - Vec3d(box.lo));
    const Vec3d center = affine.point(0.5 * (Vec3d(box.hi) + Vec3d(box.lo)));
    const glm::dmat3 size(glm::abs(affine.linear[0]), glm::abs(affine.linear[1]), glm::abs(affine.linear[2]));
    const Vec3d reach = size * half;
    return round_outward(center - reach, center + reach);
}

}  // namespace

TriangleCorners world_triangle(const Triangle& triangle, const Affine& to_world) {
    if (to_world.is_identity()) return triangle.vertices;
    const AffineD affine(to_world);
    TriangleCorners corners;
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = Vec3(affine.point(Vec3d(triangle.vertices[i])));
    return corners;
}

QuadCorners world_quad(const Quad& quad, const Affine& to_world) {
    const AffineD affine(to_world);
    const Vec3d p(quad.point), u(quad.u), v(quad.v);
    return {Vec3(affine.point(p)), Vec3(affine.point(p + u)), Vec3(affine.point(p + u + v)), Vec3(affine.point(p + v))};
}

PlaneD world_plane(const Plane& plane, const Affine& to_world) {
    const AffineD affine(to_world);
    if (to_world.is_identity()) return {Vec3d(plane.point), Vec3d(plane.normal)};
    return {affine.point(Vec3d(plane.point)), glm::transpose(glm::inverse(affine.linear)) * Vec3d(plane.normal)};
}

std::optional<SphereD> world_sphere(const Sphere& sphere, const Affine& to_world) {
    const AffineD affine(to_world);
    const glm::dmat3& m = affine.linear;
    const double scale = glm::length(m[0]);
    constexpr double kTolerance = 1e-6;
    const auto equal = [&](double a, double b) { return std::fabs(a - b) <= kTolerance * scale * scale; };
    const double squared = scale * scale;
    if (!equal(glm::dot(m[1], m[1]), squared) || !equal(glm::dot(m[2], m[2]), squared)) return {};
    if (!equal(glm::dot(m[0], m[1]), 0) || !equal(glm::dot(m[0], m[2]), 0) || !equal(glm::dot(m[1], m[2]), 0))
        return {};
    return SphereD{affine.point(Vec3d(sphere.center)), scale * sphere.radius};
}

std::optional<Box> world_box(const Box& box, const Affine& to_world) {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            const float entry = to_world.linear[column][row];
            if (row == column ? !(entry > 0) : entry != 0) return {};
        }
    }
    const AffineD affine(to_world);
    return Box{Vec3(affine.point(Vec3d(box.min))), Vec3(affine.point(Vec3d(box.max)))};
}

TracedObject::TracedObject(const GeometryInstance& instance) {
    const Affine& to_world = instance.to_world;
    const auto keep_in_own_space = [&](const auto& local) {
        shape = local;
        in_world = to_world.is_identity();
        if (!in_world) to_local = AffineD(to_world).inverse();
    };
    std::visit(Overloaded{[&](const Sphere& sphere) {
                              if (const auto baked = world_sphere(sphere, to_world)) {
                                  shape = *baked;
                              } else {
                                  keep_in_own_space(SphereD{Vec3d(sphere.center), sphere.radius});
                              }
                          },
                          [&](const Plane& plane) { shape = world_plane(plane, to_world); },
                          [&](const Box& box) {
                              if (const auto baked = world_box(box, to_world)) {
                                  shape = *baked;
                              } else {
                                  keep_in_own_space(box);
                              }
                          },
                          [&](const Triangle& triangle) { shape = world_triangle(triangle, to_world); },
                          [&](const Quad& quad) { shape = world_quad(quad, to_world); },
                          [&](const std::shared_ptr<const TriangleMesh>& mesh) { keep_in_own_space(mesh); }},
               instance.shape);
}

const TriangleMesh* TracedObject::mesh() const {
    const auto* pointer = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape);
    return pointer ? pointer->get() : nullptr;
}

bool intersect_shape(const TracedObject& object, const TracedRay& world, const TRange& range, ShapeHit& hit) {
    const auto in_own_space = [&](auto&& test) {
        return object.in_world ? test(world.ray) : test(object.to_local.ray(world.ray));
    };
    return std::visit(
        Overloaded{[&](const SphereD& sphere) {
                       return in_own_space([&](const RayD& ray) { return intersect_sphere(sphere, ray, range, hit); });
                   },
                   [&](const Box& box) {
                       return in_own_space([&](const RayD& ray) { return intersect_box(box, ray, range, hit); });
                   },
                   [&](const PlaneD& plane) { return intersect_plane(plane, world.ray, range, hit); },
                   [&](const TriangleCorners& c) {
                       return intersect_triangle(world.triangle_ray, c[0], c[1], c[2], range, hit);
                   },
                   [&](const QuadCorners& corners) { return intersect_quad(world.triangle_ray, corners, range, hit); },
                   [](const std::shared_ptr<const TriangleMesh>&) { return false; }},
        object.shape);
}

Bounds3 world_bounds(const TracedObject& object, const GeometryInstance& instance, const Bounds3& mesh_bounds) {
    const AffineD affine = object.in_world ? AffineD() : AffineD(instance.to_world);
    return std::visit(Overloaded{[&](const SphereD& s) { return bounds_of(s, affine.linear, affine.point(s.center)); },
                                 [&](const Box& box) {
                                     const Bounds3 local{box.min, box.max};
                                     return object.in_world ? local : transformed(local, affine);
                                 },
                                 [](const PlaneD&) { return Bounds3(); },
                                 [](const TriangleCorners& corners) { return bounds_of(corners); },
                                 [](const QuadCorners& corners) { return bounds_of(corners); },
                                 [&](const std::shared_ptr<const TriangleMesh>&) {
                                     return object.in_world ? mesh_bounds : transformed(mesh_bounds, affine);
                                 }},
                      object.shape);
}

Bounds3 bounds_of_triangles(const TriangleMesh& mesh) {
    Bounds3 bounds;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const Vec3 &a = mesh.positions[triangle.x], &b = mesh.positions[triangle.y], &c = mesh.positions[triangle.z];
        if (!is_finite(a) || !is_finite(b) || !is_finite(c)) continue;
        bounds.extend(a);
        bounds.extend(b);
        bounds.extend(c);
    }
    return bounds;
}

Bounds3 round_outward(const Vec3d& lo, const Vec3d& hi) {
    Bounds3 bounds;
    for (int axis = 0; axis < 3; ++axis) {
        const float below = static_cast<float>(lo[axis]), above = static_cast<float>(hi[axis]);
        bounds.lo[axis] = below > lo[axis] ? next_down(below) : below;
        bounds.hi[axis] = above < hi[axis] ? next_up(above) : above;
    }
    return bounds;
}

}  // namespace rayuela
