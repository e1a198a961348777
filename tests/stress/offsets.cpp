#include "core/accel/surface_point.h"
#include "core/lights/light_table.h"
#include "core/math/float_error.h"
#include "tests/stress/stress.h"
#include "tests/support/closed_meshes.h"
#include "tests/support/oracle.h"
#include "tests/support/scalar_list.h"

#include <fmt/format.h>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

float ulp(float x) {
    return std::nextafter(std::fabs(x), kInfinity) - std::fabs(x);
}

/// One object of any shape, size and place, coordinates up to 1e8.
GeometryInstance random_instance(Random& random) {
    const Vec3 at = random.integer(0, 3) ? log_uniform_vector(random, 1e-3f, 1e8f) : Vec3(0);
    // Not so small that the floats around `at` could not tell its sides apart.
    const float size = log_uniform(random, 1e-3f, 1e4f) + 64 * ulp(max_component(glm::abs(at)));
    TracedShape shape;
    switch (random.integer(0, 5)) {
        case 0:
            shape = Sphere{Vec3(0), 1};
            break;
        case 1:
            shape = Plane{Vec3(0), random.direction()};
            break;
        case 2:
            shape = Box{Vec3(-1), Vec3(random.uniform(-0.5f, 1), 1, 1)};
            break;
        case 3:
            shape = Triangle{{random.in_cube(), random.in_cube(), random.in_cube()}};
            break;
        case 4:
            shape = Quad{random.in_cube(), random.direction(), random.direction()};
            break;
        default:
            shape = random.integer(0, 1) ? make_tetrahedron() : make_cube();
            break;
    }
    const bool rigid = std::holds_alternative<Plane>(shape);
    switch (rigid ? 0 : random.integer(0, 3)) {
        case 0:
            return {shape, {rigid ? Mat3(1) : Mat3(size), at}};
        case 1:
            return {shape, {size * random.rotation(), at}};
        case 2: {
            Mat3 stretched = random.rotation();
            for (int i = 0; i < 3; ++i)
                stretched[i] *= size * random.uniform(0.3f, 2) * (random.integer(0, 1) ? 1.0f : -1.0f);
            return {shape, {stretched, at}};
        }
        default:
            return {shape, {Mat3(size), at}};
    }
}

/// A point that any shape of random_instance is around, in the world.
Vec3 somewhere_on(const GeometryInstance& instance, Random& random) {
    return instance.to_world.point(random.in_cube(0.8f));
}

/// What a ray that left a hit at `point` towards `w` may not meet.
bool meets_itself(const GeometryInstance& instance, const SurfacePoint& point, const Vec3& w, const Hit& first,
                  const Hit& again) {
    if (!again.valid()) return false;
    if (std::holds_alternative<Sphere>(instance.shape)) return glm::dot(w, point.ng) > 0;
    if (std::holds_alternative<Box>(instance.shape))
        return glm::dot(w, point.ng) > 0 || again.primitive == first.primitive;
    return again.primitive == first.primitive;
}

/// Both sides and down to grazing; from the sphere inwards the other end of the chord is where it should be.
Outcome reintersect(double scale) {
    constexpr std::uint64_t kRaysPerShape = 1000;
    return for_batches(
        scaled(1e8, scale), 27, kRaysPerShape, [](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            const GeometryInstance instance = random_instance(random);
            const auto list = scalar_list({instance});
            for (std::uint64_t i = 0; i < n; ++i) {
                const Vec3 target = somewhere_on(instance, random);
                const float reach = glm::length(instance.to_world.linear[0]) * log_uniform(random, 1e-2f, 1e3f);
                Ray ray{.origin = target + random.direction() * reach};
                ray.direction = random.integer(0, 3) ? target - ray.origin : random.direction();
                if (ray.direction == Vec3(0)) continue;
                const Hit hit = intersect(*list, ray);
                if (!hit.valid()) continue;
                const SurfacePoint point = surface_of(instance, ray, hit);
                Vec3 w = random.direction();
                if (i % 4 == 0)
                    w = glm::normalize(w - (1 - log_uniform(random, 1e-7f, 1)) * glm::dot(w, point.ng) * point.ng);
                // Closer to the surface than a unit normal in float can say, a direction has no side.
                if (std::fabs(glm::dot(w, point.ng)) < 0x1p-21f) continue;
                const Ray leaving{.origin = offset_ray_origin(point.p, point.p_error, point.ng, w), .direction = w};
                const auto where = [&] {
                    return fmt::format("shape {} at {} size {:g}: {} then {}", instance.shape.index(),
                                       describe(instance.to_world.translation),
                                       glm::length(instance.to_world.linear[0]), describe(ray), describe(leaving));
                };
                outcome.expect(is_finite(leaving.origin), where);
                outcome.expect(!meets_itself(instance, point, w, hit, intersect(*list, leaving)), where);
            }
        });
}

/// Shells with a gap of 64 ulp of the largest coordinate: a ray through the first finds the second.
Outcome second_shell(double scale) {
    return for_cases(scaled(1e7, scale), 28, [](Random& random, Outcome& outcome) {
        const Vec3 at = random.integer(0, 1) ? log_uniform_vector(random, 1e-3f, 1e7f) : Vec3(0);
        const float size = max_component(glm::abs(at)) + log_uniform(random, 1e-2f, 10);
        const float gap = 64 * ulp(max_component(glm::abs(at)) + size);
        std::vector<GeometryInstance> shells;
        Ray ray;
        switch (random.integer(0, 2)) {
            case 0: {
                const auto quad = [&](float y) {
                    return Quad{at + Vec3(-size, y, size), Vec3(2 * size, 0, 0), Vec3(0, 0, -2 * size)};
                };
                shells = {{quad(0), {}}, {quad(-gap), {}}};
                ray.origin = at + Vec3(random.uniform(-0.5f, 0.5f) * size, size, random.uniform(-0.5f, 0.5f) * size);
                break;
            }
            case 1:
                shells = {{Sphere{at, size}, {}}, {Sphere{at, size - gap}, {}}};
                ray.origin =
                    at + Vec3(random.uniform(-0.5f, 0.5f) * size, 3 * size, random.uniform(-0.5f, 0.5f) * size);
                break;
            default:
                shells = {{Box{at - size, at + size}, {}}, {Box{at - (size - gap), at + (size - gap)}, {}}};
                ray.origin =
                    at + Vec3(random.uniform(-0.5f, 0.5f) * size, 3 * size, random.uniform(-0.5f, 0.5f) * size);
                break;
        }
        ray.direction = Vec3(random.uniform(-0.05f, 0.05f), -1, random.uniform(-0.05f, 0.05f));
        const auto list = scalar_list(shells);
        const auto where = [&] {
            return fmt::format("shape {} at {} size {:g} {}", shells[0].shape.index(), describe(at), size,
                               describe(ray));
        };
        const Hit first = intersect(*list, ray);
        outcome.expect(first.object == 0, where);
        if (first.object != 0) return;
        const SurfacePoint point = surface_point(shells, ray, first);
        const Vec3 origin = offset_ray_origin(point.p, point.p_error, point.ng, ray.direction);
        outcome.expect(intersect(*list, {.origin = origin, .direction = ray.direction}).object == 1, where);
    });
}

/// A lamp and the ground that it lights, from 1e-6 to 1e6 apart: nothing stands between them.
Outcome shadow_rays(double scale) {
    const Material lamp = Emitter{}, ground = Diffuse{};
    constexpr std::uint64_t kRaysPerLamp = 200;
    return for_batches(
        scaled(1e7, scale), 31, kRaysPerLamp, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            const float distance = log_uniform(random, 1e-6f, 1e6f);
            const Vec3 at =
                random.integer(0, 1) ? Vec3(0) : Vec3(random.in_cube(100).x, 0, random.in_cube(100).z) * distance;
            const float size = distance * log_uniform(random, 1e-2f, 0.4f);
            TracedShape shape;
            switch (random.integer(0, 3)) {
                case 0:
                    shape = Sphere{Vec3(0), 1};
                    break;
                case 1:
                    shape = Triangle{{random.direction(), random.direction(), random.direction()}};
                    break;
                case 2:
                    shape = Quad{Vec3(-0.5f), random.direction(), random.direction()};
                    break;
                default:
                    shape = make_tetrahedron();
                    break;
            }
            const std::vector<GeometryInstance> instances{{shape, {size * Mat3(1), at + Vec3(0, distance, 0)}},
                                                          {Plane{at, Vec3(0, 1, 0)}, {}}};
            const Material* const materials[] = {&lamp, &ground};
            const LightTable lights(instances, materials, NoEnvironment{});
            const auto list = scalar_list(instances);
            for (std::uint64_t i = 0; i < n; ++i) {
                Ray down{.origin = at + distance * Vec3(random.uniform(-2, 2), 0.4f, random.uniform(-2, 2)),
                         .direction = Vec3(0, -1, 0)};
                down.direction += 0.5f * random.in_cube();
                const Hit hit = intersect(*list, down);
                if (hit.object != 1) continue;
                const SurfacePoint point = surface_point(instances, down, hit);
                const Vec2 u(random.uniform(0, 0.999999f), random.uniform(0, 0.999999f));
                const auto light = lights.sample({point.p, point.ng}, u);
                if (!light || light->wi.y <= 0) continue;
                const Vec3 origin = offset_ray_origin(point.p, point.p_error, point.ng, light->wi);
                const Ray shadow = shadow_ray(origin, *light);
                std::uint8_t blocked = 0;
                list->occluded({&shadow, 1}, {&blocked, 1});
                outcome.expect(!blocked, [&] {
                    return fmt::format("lamp {} distance {:g} at {}: {}", shape.index(), distance, describe(at),
                                       describe(shadow));
                });
            }
        });
}

}  // namespace

std::vector<StressTest> offset_tests() {
    return {{27, "leaving rays do not meet their own surface", "self-hits", 0, reintersect},
            {28, "a second shell 64 ulp behind is found", "missed shells", 0, second_shell},
            {31, "shadow rays to lights 1e-6 to 1e6 away", "wrong shadows", 0, shadow_rays}};
}

}  // namespace rayuela::stress
