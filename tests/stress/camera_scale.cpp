#include "core/render/camera_rays.h"
#include "tests/stress/paths.h"
#include "tests/support/oracle.h"
#include "tests/support/scaled_scene.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;
using namespace rayuela::testing;

constexpr int kRows = 720;

/// Where the ray of an image position falls on the image plane, in long double, in pixels of 720 rows; and that its
/// direction is rounded to float once, in each component.
Outcome unproject(double scale, float min_vfov, float max_vfov) {
    return for_cases(scaled(1e7, scale), 50, [=](Random& random, Outcome& outcome) {
        Camera camera;
        camera.position = random.integer(0, 1) ? random.in_cube(10) : random.direction() * 1e6f;
        camera.target = camera.position + random.direction() * log_uniform(random, 1, 1e3f);
        camera.up = random.direction();
        camera.vfov = log_uniform(random, min_vfov, max_vfov);
        if (camera.target == camera.position) return;
        const double aspect = 16.0 / 9;
        const Vec2 position(random.uniform(), random.uniform());
        const Ray ray = CameraRays(camera, aspect).ray(position, Vec2(0));
        outcome.expect(is_finite(ray.direction) && std::fabs(glm::length(ray.direction) - 1) < 1e-6f,
                       [&] { return describe(ray); });

        const Vec3l forward = glm::normalize(Vec3l(camera.target) - Vec3l(camera.position));
        if (std::fabs(glm::dot(forward, glm::normalize(Vec3l(camera.up)))) > 0.999L) return;
        const Vec3l right = glm::normalize(glm::cross(forward, Vec3l(camera.up))), up = glm::cross(right, forward);
        const Vec3l d(ray.direction);
        const Real half = std::tan(glm::radians(Real(camera.vfov)) / 2), z = glm::dot(d, forward);
        const Real x = glm::dot(d, right) / z / (half * Real(aspect)), y = -glm::dot(d, up) / z / half;
        const Real dx = (x + 1) / 2 - Real(position.x), dy = (y + 1) / 2 - Real(position.y);
        outcome.measure(static_cast<double>(std::hypot(dx * Real(aspect), dy) * kRows));

        const Vec3l exact = glm::normalize(forward + (2 * Real(position.x) - 1) * half * Real(aspect) * right +
                                           (1 - 2 * Real(position.y)) * half * up);
        for (int axis = 0; axis < 3; ++axis) {
            // Half an ulp, and as much of double as its 30 operations lose.
            outcome.expect(std::fabs(d[axis] - exact[axis]) <= kU * std::fabs(exact[axis]) + 0x1p-48L,
                           [&] { return describe(ray); });
        }
    });
}

Outcome ordinary_lenses(double scale) {
    return unproject(scale, 0.2f, 179);
}

/// No ray in float does better here: the components of a unit direction lie up to 2^-24 apart, so that along a diagonal
/// of the axes rounding each turns the direction by up to sqrt(2/3) 2^-24 = 4.9e-8 radians, and a pixel of 0.1 degrees in
/// 720 rows is 2.4e-6: 0.0201 of it.
Outcome long_lenses(double scale) {
    return unproject(scale, 0.1f, 0.2f);
}

/// Views without a direction, along `up`, of any size.
Outcome degenerate_views(double scale) {
    return for_cases(scaled(1e6, scale), 50, [](Random& random, Outcome& outcome) {
        Camera camera;
        camera.position = log_uniform_vector(random, 1e-30f, 1e30f);
        camera.up = log_uniform_vector(random, 1e-30f, 1e30f);
        camera.target = camera.position;
        if (random.integer(0, 3)) camera.target += random.uniform(-2, 2) * camera.up;
        if (random.integer(0, 3) == 0) camera.up = Vec3(0);
        camera.vfov = log_uniform(random, 0.01f, 179.9f);
        camera.lens_radius = random.integer(0, 1) ? 0 : random.uniform();
        const Ray ray =
            CameraRays(camera, 1.5).ray(Vec2(random.uniform(), random.uniform()), Vec2(random.uniform(-0.7f, 0.7f)));
        outcome.expect(is_finite(ray.origin) && std::fabs(glm::length(ray.direction) - 1) < 1e-5f,
                       [&] { return describe(ray); });
    });
}

void move_by(Scene& scene, const Vec3& offset) {
    scene.camera.position += offset;
    scene.camera.target += offset;
    for (Object& object : scene.objects) object.transform.translate += offset;
}

struct Picture {
    std::vector<Vec3d> means;
    std::vector<double> variances;
    std::vector<std::uint32_t> ids;
};

Picture picture(const Scene& scene, int samples) {
    const auto accumulation = render(scene, samples, {}, tbb::this_task_arena::max_concurrency());
    Picture result{means(accumulation->film()), {}, accumulation->object_ids()};
    for (std::size_t i = 0; i < result.means.size(); ++i)
        result.variances.push_back(accumulation->film().variance_of_mean(i));
    return result;
}

double relative_mse(const Picture& a, const Picture& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.means.size(); ++i) {
        const Vec3d d = a.means[i] - b.means[i];
        sum += glm::dot(d, d) / (glm::dot(a.means[i], a.means[i]) + 0.03);
    }
    return sum / static_cast<double>(a.means.size());
}

double share_of_other_ids(const Picture& a, const Picture& b) {
    std::size_t others = 0;
    for (std::size_t i = 0; i < a.ids.size(); ++i) others += a.ids[i] != b.ids[i] ? 1 : 0;
    return static_cast<double>(others) / static_cast<double>(a.ids.size());
}

/// z of the mean luminance of the two images.
double difference_in_sigmas(const Picture& a, const Picture& b) {
    double difference = 0, variance = 0;
    for (std::size_t i = 0; i < a.means.size(); ++i) {
        difference += glm::dot(a.means[i] - b.means[i], Vec3d(0.2126, 0.7152, 0.0722));
        variance += a.variances[i] + b.variances[i];
    }
    return difference / std::sqrt(variance);
}

Scene lens_scene() {
    Scene scene = mixed_scene(96, 64);
    scene.camera.lens_radius = 0.03f;
    scene.camera.focus_distance = 7;
    return scene;
}

Outcome powers_of_two(double scale) {
    const int samples = static_cast<int>(scaled(64, scale, 1));
    const Picture expected = picture(lens_scene(), samples);
    Outcome outcome;
    for (int k = -20; k <= 20; ++k) {
        const Picture scaled_picture = picture(scaled_by(lens_scene(), std::ldexp(1.0f, k)), samples);
        for (std::size_t i = 0; i < expected.means.size(); ++i) {
            outcome.expect(scaled_picture.means[i] == expected.means[i],
                           [&] { return fmt::format("2^{} pixel {}", k, i); });
        }
        outcome.cases += expected.means.size() * static_cast<std::uint64_t>(samples);
    }
    return outcome;
}

/// Figure: the share of camera rays that meet another object; the image may differ by the noise of paths that rounding
/// sends elsewhere.
Outcome powers_of_ten(double scale) {
    constexpr int kSamples = 256;
    const int samples = static_cast<int>(scaled(kSamples, scale, 4));
    // The error of paths that are sent elsewhere falls as that of all others does.
    const double most = 1e-6 * kSamples / samples;
    const Picture expected = picture(lens_scene(), samples);
    Outcome outcome;
    for (int k = -6; k <= 6; ++k) {
        const Picture other = picture(scaled_by(lens_scene(), std::pow(10.0f, static_cast<float>(k))), samples);
        outcome.measure(share_of_other_ids(expected, other));
        const double error = relative_mse(expected, other);
        outcome.expect(error <= most, [&] { return fmt::format("1e{}: relMSE {:g}", k, error); });
        outcome.cases += expected.means.size() * static_cast<std::uint64_t>(samples);
    }
    return outcome;
}

/// The mixed scene with every place on a grid of 1/16.
Scene grid_scene() {
    Scene scene = empty_scene(96, 64);
    scene.camera.position = Vec3(0, 2.5f, 7);
    scene.camera.target = Vec3(0, 0.75f, 0);
    scene.environment = GradientEnvironment{Color(0.3f), Color(0.2f, 0.3f, 0.5f)};
    scene.render.sampler = SamplerKind::independent;
    const MaterialId clay = add_material(scene, Diffuse{{Color(0.7f, 0.45f, 0.3f), nullptr}});
    const MaterialId gold = add_material(scene, Metal{{Color(0.9f, 0.75f, 0.45f), nullptr}, {0.5f, nullptr, 0}});
    const MaterialId plastic = add_material(scene, Principled{.base_color = {Color(0.2f, 0.5f, 0.3f), nullptr}});
    const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(8, 7, 6), nullptr}});
    add_object(scene, Plane{}, clay);
    add_object(scene, Sphere{Vec3(-1.75f, 0.75f, 0), 0.75f}, gold);
    add_object(scene, Box{Vec3(1, 0, -0.5f), Vec3(2, 1.25f, 0.5f)}, plastic);
    add_object(scene, Mesh{"torus", torus_mesh()}, gold, {.translate = Vec3(0, 0.5f, -0.625f)});
    add_object(scene, Quad{Vec3(-1, 4, 1), Vec3(2, 0, 0), Vec3(0, 0, 1)}, lamp);
    return scene;
}

/// Figure: the share of camera rays that meet another object after a move of 1e6 on the grid.
Outcome translation(double scale) {
    const int samples = static_cast<int>(scaled(1024, scale, 16));
    const Picture expected = picture(grid_scene(), samples);
    Outcome outcome;
    for (const Vec3& offset : {Vec3(1e6f, 0, 0), Vec3(-250000.25f, 1e6f, 3e5f), Vec3(1e6f)}) {
        Scene scene = grid_scene();
        move_by(scene, offset);
        scene.render.seed = 1;
        const Picture other = picture(scene, samples);
        outcome.measure(share_of_other_ids(expected, picture(
                                                         [&] {
                                                             Scene same = scene;
                                                             same.render.seed = 0;
                                                             return same;
                                                         }(),
                                                         1)));
        const double z = difference_in_sigmas(expected, other);
        outcome.expect(std::fabs(z) < 4,
                       [&] { return fmt::format("by {}: the mean differs by {:.1f} sigma", describe(offset), z); });
        outcome.cases += expected.means.size() * static_cast<std::uint64_t>(samples);
    }
    return outcome;
}

}  // namespace

std::vector<StressTest> camera_scale_tests() {
    return {{50, "camera: rays through their pixels, 0.2 to 179 degrees", "pixels of 720 rows", 0.01, ordinary_lenses},
            {50, "camera: rays through their pixels, 0.1 to 0.2", "pixels of 720 rows", 0.0201, long_lenses},
            {50, "camera: views without direction", "-", 0, degenerate_views},
            {51, "scale by 2^-20 to 2^20: identical images", "-", 0, powers_of_two},
            {52, "scale by 1e-6 to 1e6", "share of other objects", 1e-3, powers_of_ten},
            {53, "translation by 1e6", "share of other objects", 1e-3, translation}};
}

}  // namespace rayuela::stress
