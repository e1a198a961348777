#include "tests/statistics.h"
#include "tests/stress/paths.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <numbers>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;
using namespace rayuela::testing;

constexpr PathTracerOptions kScatteringOnly{.light_sampling = false, .mis = false, .russian_roulette = false};

std::unique_ptr<Accumulation> render_parallel(const Scene& scene, int samples, const PathTracerOptions& options = {}) {
    return render(scene, samples, options, tbb::this_task_arena::max_concurrency());
}

void look_at(Scene& scene, const Vec3& position, const Vec3& target, float vfov) {
    scene.camera.position = position;
    scene.camera.target = target;
    scene.camera.up = Vec3(0.1f, 0.2f, 1);
    scene.camera.vfov = vfov;
}

/// What loses no light vanishes in a world of radiance 1.
Outcome vanishing_objects(double scale) {
    const int samples = static_cast<int>(scaled(1024, scale, 4));
    const Material lossless[] = {Diffuse{{Color(1), nullptr}}, Metal{{Color(1), nullptr}, {0, nullptr, 0}},
                                 Dielectric{}, Dielectric{.ior = 2.4f}};
    auto torus = std::make_shared<TriangleMesh>(*torus_mesh());
    torus->normals.clear();  // interpolated normals do lose light
    Outcome outcome;
    for (const Material& material : lossless) {
        Scene scene = empty_scene(96, 64);
        scene.environment = ConstantEnvironment{Color(1)};
        scene.render.max_bounces = 1000;
        const MaterialId id = add_material(scene, material);
        add_object(scene, Sphere{Vec3(-1, 1, 0), 1}, id);
        add_object(scene, Box{Vec3(0.2f, 0, -0.5f), Vec3(1.5f, 1.5f, 0.7f)}, id);
        add_object(scene, Quad{Vec3(-2, 0, 2), Vec3(4, 0, 0), Vec3(0, 0, -4)}, id);
        add_object(scene, Mesh{"torus", torus}, id, {.translate = Vec3(0, 2, -1)});
        const auto accumulation = render_parallel(scene, samples);
        const Film& film = accumulation->film();
        Vec3d whole(0);
        for (std::size_t pixel = 0; pixel < 96 * 64; ++pixel) {
            const Vec3d mean = film.mean(pixel);
            const double off = std::max({std::fabs(mean.x - 1), std::fabs(mean.y - 1), std::fabs(mean.z - 1)});
            outcome.expect(off <= 1e-5 + 5 * std::sqrt(film.variance_of_mean(pixel)), [&] {
                return fmt::format("material {} pixel {} off by {:g}", material.index(), pixel, off);
            });
            whole += mean / (96.0 * 64);
        }
        for (int channel = 0; channel < 3; ++channel) outcome.measure(std::fabs(whole[channel] - 1));
        outcome.cases += std::uint64_t(96 * 64) * static_cast<std::uint64_t>(samples);
    }
    return outcome;
}

struct ClosedForm {
    std::string name;
    Scene scene;
    double radiance;
};

/// A diffuse cavity of radius R and albedo a around a ball of radius r and radiance L: from the wall the ball fills
/// f = (r / R)^2 of the cosine-weighted hemisphere, so that a camera sees a L f times the sum of (a (1 - f))^k.
ClosedForm cavity(int max_bounces) {
    constexpr double kAlbedo = 0.8, kF = 0.09, kL = 5, kRatio = kAlbedo * (1 - kF);
    Scene scene = empty_scene(128, 128);
    scene.render.max_bounces = max_bounces;
    look_at(scene, Vec3(0, 0, -1), Vec3(0, 0, -2), 60);
    add_object(scene, Sphere{Vec3(0), 2}, add_material(scene, Diffuse{{Color(static_cast<float>(kAlbedo)), nullptr}}));
    add_object(scene, Sphere{Vec3(0), 0.6f},
               add_material(scene, Emitter{.radiance = {Color(static_cast<float>(kL)), nullptr}}));
    return {fmt::format("cavity, {} bounces", max_bounces), scene,
            kAlbedo * kL * kF * (1 - std::pow(kRatio, max_bounces)) / (1 - kRatio)};
}

ClosedForm inside_of_a_lamp() {
    Scene scene = empty_scene(128, 128);
    look_at(scene, Vec3(0, 1, 0.2f), Vec3(0), 0.01f);
    add_object(scene, Quad{Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)},
               add_material(scene, Diffuse{{Color(0.5f), nullptr}}));
    add_object(scene, Sphere{Vec3(0), 10}, add_material(scene, Emitter{{Color(3), nullptr}, true}));
    return {"inside of a lamp", scene, 1.5};
}

/// From a horizontal element to a parallel a x b rectangle at height 1, the element under one corner.
double corner_form_factor(double a, double b) {
    const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
    return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * std::numbers::pi);
}

ClosedForm quad_above_a_floor() {
    Scene scene = empty_scene(128, 128);
    scene.render.max_bounces = 1;
    look_at(scene, Vec3(3, 0.5f, 0), Vec3(0), 0.01f);
    add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.6f), nullptr}}));
    // From (-1, -0.5) to (2, 1.5) as seen from the origin, facing down.
    add_object(scene, Quad{Vec3(-1, 1, -0.5f), Vec3(3, 0, 0), Vec3(0, 0, 2)},
               add_material(scene, Emitter{.radiance = {Color(4), nullptr}}));
    return {"quad above a floor", scene,
            0.6 * 4 *
                (corner_form_factor(1, 0.5) + corner_form_factor(2, 0.5) + corner_form_factor(1, 1.5) +
                 corner_form_factor(2, 1.5))};
}

/// Wholly above the horizon: L (r / d)^2 cos.
ClosedForm sphere_above_a_floor() {
    Scene scene = empty_scene(128, 128);
    scene.render.max_bounces = 1;
    look_at(scene, Vec3(3, 0.5f, 0), Vec3(0), 0.01f);
    add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.6f), nullptr}}));
    add_object(scene, Sphere{Vec3(0, 3, -4), 1.5f}, add_material(scene, Emitter{.radiance = {Color(4), nullptr}}));
    return {"sphere above a floor", scene, 0.6 * 4 * 0.09 * 0.6};
}

/// Figure: the relative error where the noise lets it be told from 1e-3; in any case |z| < 4.
Outcome closed_forms(double scale) {
    constexpr double kRequired = 1e-3;
    const std::vector<ClosedForm> forms{
        cavity(1), cavity(5), cavity(200), inside_of_a_lamp(), quad_above_a_floor(), sphere_above_a_floor()};
    const PathTracerOptions variants[] = {{}, {.mis = false}, kScatteringOnly};
    const int samples = static_cast<int>(scaled(1e8 / (128 * 128 * 18), scale, 2));
    Outcome outcome;
    for (const ClosedForm& form : forms) {
        for (const PathTracerOptions& options : variants) {
            Scene scene = form.scene;
            scene.render.sampler = SamplerKind::independent;
            const Estimate got = estimate(render_parallel(scene, samples, options)->film());
            // The view is not a point: the closed form holds at its centre.
            constexpr double kOfTheView = 1e-4;
            const double error = std::max(0.0, std::fabs(got.mean - form.radiance) - kOfTheView * form.radiance);
            const double sigma = std::sqrt(got.variance);
            if (4 * sigma < kRequired * form.radiance) outcome.measure(error / form.radiance);
            outcome.expect(error < 4 * sigma + 1e-6 * form.radiance, [&] {
                return fmt::format("{}, light samples {} mis {}: {:.6f} +- {:.6f}, expected {:.6f}", form.name,
                                   options.light_sampling, options.mis, got.mean, sigma, form.radiance);
            });
            outcome.cases += std::uint64_t(128 * 128) * static_cast<std::uint64_t>(samples);
        }
    }
    return outcome;
}

/// Probability that n uniform numbers are as far from uniform (Kolmogorov & Smirnov, asymptotic).
double uniformity_p_value(std::vector<double> values) {
    std::ranges::sort(values);
    const double n = static_cast<double>(values.size());
    double distance = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto rank = static_cast<double>(i);
        distance = std::max({distance, values[i] - rank / n, (rank + 1) / n - values[i]});
    }
    const double lambda = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
    double p = 0;
    for (int k = 1; k < 100; ++k) p += 2 * (k % 2 ? 1 : -1) * std::exp(-2.0 * k * k * lambda * lambda);
    return std::clamp(p, 0.0, 1.0);
}

/// Nothing so narrow that tiles would not be normally distributed.
Scene gentle_scene() {
    Scene scene = empty_scene(64, 48);
    scene.camera.position = Vec3(0, 1.2f, 3);
    scene.camera.target = Vec3(0, 0.6f, 0);
    scene.render.sampler = SamplerKind::independent;
    scene.render.rr_start = 2;
    scene.environment = ConstantEnvironment{Color(0.3f)};
    const MaterialId clay = add_material(scene, Diffuse{{Color(0.4f, 0.3f, 0.2f), nullptr}});
    const MaterialId brushed = add_material(scene, Metal{{Color(0.7f), nullptr}, {0.7f, nullptr, 0}});
    add_object(scene, Plane{}, clay);
    add_object(scene, Sphere{Vec3(-0.7f, 0.5f, 0), 0.5f}, brushed);
    add_object(scene, Box{Vec3(0.1f, 0, -0.4f), Vec3(1, 0.8f, 0.4f)}, clay);
    add_object(scene, Quad{Vec3(-2, 2.5f, -2), Vec3(4, 0, 0), Vec3(0, 0, 4)},
               add_material(scene, Emitter{.radiance = {Color(1.5f), nullptr}}));
    return scene;
}

std::vector<Estimate> tiles(const Film& film) {
    constexpr int kSide = 8;
    std::vector<Estimate> result;
    for (int y0 = 0; y0 < film.height(); y0 += kSide) {
        for (int x0 = 0; x0 < film.width(); x0 += kSide) {
            Estimate tile;
            for (int i = 0; i < kSide * kSide; ++i) {
                const auto pixel = static_cast<std::size_t>((y0 + i / kSide) * film.width() + x0 + i % kSide);
                const Vec3d mean = film.mean(pixel);
                tile.mean += (0.2126 * mean.x + 0.7152 * mean.y + 0.0722 * mean.z) / (kSide * kSide);
                tile.variance += film.variance_of_mean(pixel) / std::pow(kSide, 4);
            }
            result.push_back(tile);
        }
    }
    return result;
}

/// Pairs of estimators of the same image, tile by tile: their p-values are uniform. Figure: 0.001 over the p-value of that.
Outcome estimators_agree(double scale) {
    const int samples = static_cast<int>(scaled(1024, scale, 8)), seeds = 16;
    const std::pair<PathTracerOptions, PathTracerOptions> pairs[] = {{{}, kScatteringOnly},
                                                                     {{.mis = false}, {.russian_roulette = false}},
                                                                     {{}, {.light_sampling = false, .mis = false}}};
    Scene scene = gentle_scene();
    Outcome outcome;
    for (const auto& [a, b] : pairs) {
        std::vector<double> p_values;
        for (int seed = 0; seed < seeds; ++seed) {
            const auto of = [&](const PathTracerOptions& options) {
                ++scene.render.seed;
                return tiles(render_parallel(scene, samples, options)->film());
            };
            const std::vector<Estimate> left = of(a), right = of(b);
            for (std::size_t i = 0; i < left.size(); ++i) {
                const double variance = left[i].variance + right[i].variance;
                if (variance == 0) continue;  // nothing but sky or lamp
                const double z = (left[i].mean - right[i].mean) / std::sqrt(variance);
                p_values.push_back(std::erfc(std::fabs(z) / std::numbers::sqrt2));
            }
            outcome.cases += 2 * left.size() * 64 * static_cast<std::uint64_t>(samples);
        }
        outcome.measure(0.001 / uniformity_p_value(std::move(p_values)));
    }
    return outcome;
}

}  // namespace

std::vector<StressTest> radiometry_tests() {
    return {{37, "furnace: lossless objects vanish from the image", "|mean - 1|", 1e-4, vanishing_objects},
            {43, "closed forms: cavity, lamps over a floor", "relative error", 1e-3, closed_forms},
            {44, "light samples, MIS, roulette: the same image", "0.001 / p of KS", 1, estimators_agree}};
}

}  // namespace rayuela::stress
