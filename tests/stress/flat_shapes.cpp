#include "core/accel/surface_point.h"
#include "core/math/basis.h"
#include "core/shapes/intersect_box.h"
#include "core/shapes/intersect_plane.h"
#include "core/shapes/intersect_triangle.h"
#include "tests/stress/stress.h"
#include "tests/support/oracle.h"

#include <fmt/format.h>

#include <bit>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

/// A hit on the only object.
Hit as_hit(const ShapeHit& hit) {
    return {hit.t, hit.u, hit.v, 0, hit.primitive};
}

/// Rays at random and down to a cosine of 1e-7 with the plane; some exactly parallel.
Outcome plane_equation(double scale) {
    return for_cases(scaled(1e8, scale), 4, [](Random& random, Outcome& outcome) {
        Plane plane{log_uniform_vector(random, 1e-3f, 1e3f), random.direction() * log_uniform(random, 1e-2f, 1e2f)};
        Ray ray{.origin = plane.point + log_uniform_vector(random, 1e-3f, 1e3f), .direction = random.direction()};
        const int kind = random.integer(0, 7);
        if (kind < 4) {
            const Basis frame(glm::normalize(plane.normal));
            const float phi = random.uniform(0, 2 * kPi), slope = log_uniform(random, 1e-7f, 1);
            ray.direction = std::cos(phi) * frame.s + std::sin(phi) * frame.t + slope * frame.n;
        } else if (kind == 4) {
            plane.normal = {plane.normal.x, plane.normal.y, 0};
            ray.direction = {-plane.normal.y, plane.normal.x, random.uniform(-1, 1)};
        }
        const Vec3l normal(plane.normal), d(ray.direction);
        const Real speed = glm::dot(normal, d), distance = glm::dot(normal, Vec3l(plane.point) - Vec3l(ray.origin));
        const Real t = distance / speed, rounding = 0x1p-50L * glm::dot(glm::abs(normal), glm::abs(d));
        ShapeHit hit;
        const bool found = intersect_plane({Vec3d(plane.point), Vec3d(plane.normal)}, RayD(ray), {}, hit);
        const auto where = [&] {
            return fmt::format("point {} normal {} {}", describe(plane.point), describe(plane.normal), describe(ray));
        };
        if (speed == 0) outcome.expect(!found, where);
        if (std::fabs(speed) > rounding) outcome.expect(found == (t >= 0 && t < 0x1p127L), where);
        if (!found || hit.t > 1e30f) return;
        const Vec3l p(surface_of({plane, {}}, ray, as_hit(hit)).p), n = glm::normalize(normal);
        const Real offset = -glm::dot(n, Vec3l(plane.point));
        const Real residual = std::fabs(glm::dot(n, p) + offset);
        const Real magnitude = glm::dot(glm::abs(n), glm::abs(p)) + std::fabs(offset);
        outcome.measure(static_cast<double>(residual / (kU * magnitude)));
    });
}

struct BoxOracle {
    Real enter = -INFINITY, leave = INFINITY;
};

/// Slabs in long double; the faces belong to the box. An empty interval is a miss.
BoxOracle solve_box(const Box& box, const Ray& ray) {
    BoxOracle oracle;
    for (int axis = 0; axis < 3; ++axis) {
        const Real o = ray.origin[axis], d = ray.direction[axis], lo = box.min[axis], hi = box.max[axis];
        if (d == 0) {
            if (o < lo || o > hi) return {INFINITY, -INFINITY};
            continue;
        }
        const Real a = (lo - o) / d, b = (hi - o) / d;
        oracle.enter = std::fmax(oracle.enter, std::fmin(a, b));
        oracle.leave = std::fmin(oracle.leave, std::fmax(a, b));
    }
    return oracle;
}

Ray ray_at_box(Random& random, const Box& box) {
    const Vec3 size = box.max - box.min;
    const auto inside = [&] { return box.min + size * Vec3(random.uniform(), random.uniform(), random.uniform()); };
    Ray ray{.origin = random.integer(0, 3) ? inside() + log_uniform_vector(random, 1e-2f, 1e3f) * max_component(size)
                                           : inside()};
    Vec3 target = inside();
    // Onto a face, an edge or a corner.
    if (random.integer(0, 3) == 0) {
        for (int k = random.integer(1, 3); k > 0; --k) {
            const int axis = random.integer(0, 2);
            target[axis] = random.integer(0, 1) ? box.min[axis] : box.max[axis];
        }
    }
    const int axis = random.integer(0, 2);
    if (random.integer(0, 7) == 0) ray.origin[axis] = random.integer(0, 1) ? box.min[axis] : box.max[axis];
    ray.direction = target - ray.origin;
    for (int k = random.integer(0, 3) ? 0 : random.integer(1, 2); k > 0; --k) {
        const int zero = random.integer(0, 2);
        ray.origin[zero] = target[zero];
        ray.direction[zero] = random.integer(0, 1) ? 0.0f : -0.0f;
    }
    return ray;
}

Outcome box_faces(double scale) {
    return for_cases(scaled(1e8, scale), 5, [](Random& random, Outcome& outcome) {
        const Vec3 corner = random.integer(0, 1) ? random.in_cube(1) : log_uniform_vector(random, 1e-3f, 1e5f);
        const Vec3 size = glm::abs(log_uniform_vector(random, 1e-3f, 1e3f));
        const Box box{corner, corner + size * Vec3(1, random.integer(0, 7) ? 1 : 0, 1)};
        const Ray ray = ray_at_box(random, box);
        if (ray.direction == Vec3(0)) return;
        const BoxOracle expected = solve_box(box, ray);
        const auto where = [&] {
            return fmt::format("box {} {} {}", describe(box.min), describe(box.max), describe(ray));
        };
        ShapeHit hit;
        const bool found = intersect_box(box, RayD(ray), {}, hit);
        if (expected.enter <= expected.leave && expected.leave >= 0) outcome.expect(found, where);
        const Real margin = 0x1p-48L * std::fmax(std::fabs(expected.enter), std::fabs(expected.leave));
        if (expected.enter > expected.leave + margin || expected.leave < 0) outcome.expect(!found, where);
        if (!found) return;
        const SurfacePoint point = surface_of({box, {}}, ray, as_hit(hit));
        const int axis = static_cast<int>(hit.primitive / 2);
        const float face = (hit.primitive % 2 ? box.max : box.min)[axis];
        outcome.expect(is_finite(point.p) && std::bit_cast<std::uint32_t>(point.p[axis] + 0.0f) ==
                                                 std::bit_cast<std::uint32_t>(face + 0.0f),
                       where);
        outcome.expect(
            glm::all(glm::greaterThanEqual(point.p, box.min)) && glm::all(glm::lessThanEqual(point.p, box.max)), where);
        const Real t = expected.enter >= 0 ? expected.enter : expected.leave;
        if (t > 1e-30L && std::fabs(expected.enter) > 1e-15L * t)
            outcome.measure(static_cast<double>(std::fabs(hit.t - t) / t));
    });
}

/// Moeller & Trumbore in long double.
Outcome triangle_parameters(double scale) {
    return for_cases(scaled(1e7, scale), 6, [](Random& random, Outcome& outcome) {
        const Vec3 at = random.in_cube(random.integer(0, 1) ? 10.0f : 1.0f);
        const Triangle triangle{{at, at + random.in_cube(), at + random.in_cube()}};
        const Vec3 &a = triangle.vertices[0], &b = triangle.vertices[1], &c = triangle.vertices[2];
        const Vec3l e1 = Vec3l(b) - Vec3l(a), e2 = Vec3l(c) - Vec3l(a), cross = glm::cross(e1, e2);
        const float x = std::sqrt(random.uniform()), y = random.uniform();
        Ray ray{.origin = at + random.in_cube(5)};
        ray.direction = a + x * (1 - y) * (b - a) + x * y * (c - a) - ray.origin;
        const Vec3l d(ray.direction), from_a = Vec3l(ray.origin) - Vec3l(a);
        const Real determinant = -glm::dot(cross, d);
        // Well-conditioned: neither thin nor seen from the edge.
        if (glm::length(cross) < 0.1L * glm::length(e1) * glm::length(e2)) return;
        if (std::fabs(determinant) < 0.1L * glm::length(cross) * glm::length(d)) return;
        const Real t = glm::dot(cross, from_a) / determinant;
        const Real u = glm::dot(glm::cross(from_a, d), e2) / determinant;
        const Real v = glm::dot(glm::cross(d, from_a), e1) / determinant;
        ShapeHit hit;
        const TriangleRay exact{RayD(ray)};
        const bool found = intersect_triangle(exact, a, b, c, {}, hit);
        if (std::fmin(u, std::fmin(v, 1 - u - v)) > 1e-12L && t > 0)
            outcome.expect(found, [&] { return describe(ray); });
        if (!found) return;
        constexpr Real kFloor = 0x1p-20L;
        outcome.measure(ulp_error(hit.t, t, kFloor));
        outcome.measure(ulp_error(hit.u, u, kFloor));
        outcome.measure(ulp_error(hit.v, v, kFloor));
        const SurfacePoint point = surface_of({triangle, {}}, ray, as_hit(hit));
        const Vec3l n = cross / glm::length(cross);
        for (int axis = 0; axis < 3; ++axis) outcome.measure(ulp_error(point.ng[axis], n[axis], kFloor));
    });
}

/// Without area, with a vertex twice, up to 1e8 times as long as wide.
std::array<Vec3, 3> sliver(Random& random) {
    const Vec3 a = random.in_cube() * (random.integer(0, 1) ? 1.0f : 100.0f), b = a + random.in_cube();
    switch (random.integer(0, 4)) {
        case 0:
            return {a, b, random.integer(0, 1) ? a : b};
        case 1:
            return {a, b, a + random.uniform(-1, 2) * (b - a)};
        case 2:
            return {a, a, a};
        default:
            return {a, b, glm::mix(a, b, random.uniform()) + random.direction() * log_uniform(random, 1e-8f, 1e-3f)};
    }
}

Outcome slivers(double scale) {
    return for_batches(
        scaled(1e7, scale), 10, 512, [](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            std::vector<Vec3> positions;
            std::vector<glm::uvec3> triangles;
            for (std::uint32_t i = 0; i < 64; ++i) {
                const auto corners = sliver(random);
                positions.insert(positions.end(), corners.begin(), corners.end());
                triangles.push_back({3 * i, 3 * i + 1, random.integer(0, 9) ? 3 * i + 2 : 3 * i});
            }
            const GeometryInstance instance{make_mesh(positions, triangles), {}};
            const auto kd = build({instance}, {.kind = AcceleratorKind::kd, .leaf_size = random.integer(1, 8)});
            for (std::uint64_t i = 0; i < n; ++i) {
                const auto first = static_cast<std::size_t>(3 * random.integer(0, 63));
                Ray ray{.origin = random.in_cube(random.integer(0, 1) ? 2.0f : 200.0f)};
                ray.direction =
                    glm::mix(positions[first], glm::mix(positions[first + 1], positions[first + 2], random.uniform()),
                             random.uniform()) -
                    ray.origin;
                const Hit hit = intersect(*kd, ray);
                if (!hit.valid()) continue;
                const SurfacePoint point = surface_of(instance, ray, hit);
                outcome.expect(hit.u >= 0 && hit.v >= 0 && hit.u <= 1 && hit.v <= 1 && hit.u + hit.v <= 1 + 0x1p-22f,
                               [&] { return fmt::format("u {} v {} {}", hit.u, hit.v, describe(ray)); });
                outcome.expect(is_finite(point.p) && is_finite(point.p_error) && is_finite(point.ng) &&
                                   is_finite(point.ns) && std::fabs(glm::length(point.ng) - 1) < 1e-5f,
                               [&] { return fmt::format("normal {} {}", describe(point.ng), describe(ray)); });
            }
        });
}

}  // namespace

std::vector<StressTest> flat_shape_tests() {
    return {{4, "plane: its equation at the hit point, to grazing", "units of u", 3, plane_equation},
            {5, "box: faces bit for bit, no false miss", "relative error of t", 1.2e-7, box_faces},
            {6, "triangle: t, u, v, normal", "ulp", 8, triangle_parameters},
            {10, "slivers: nothing NaN, barycentrics in [0, 1]", "-", 0, slivers}};
}

}  // namespace rayuela::stress
