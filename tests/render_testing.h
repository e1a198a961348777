#pragma once

#include "core/render/accumulation.h"
#include "core/render/render_scene.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

/// Scenes and renders for the tests of the renderer.
namespace rayuela::testing {

inline MaterialId add_material(Scene& scene, Material material) {
    const MaterialId id{scene.next_id++};
    scene.materials.push_back({id, "m" + std::to_string(id.value), std::move(material)});
    return id;
}

inline ObjectId add_object(Scene& scene, Shape shape, MaterialId material = {}, Transform transform = {}) {
    Object object;
    object.id = ObjectId{scene.next_id++};
    object.name = "o" + std::to_string(object.id.value);
    object.shape = std::move(shape);
    object.material = material;
    object.transform = transform;
    scene.objects.push_back(object);
    return object.id;
}

inline Scene empty_scene(int width, int height) {
    Scene scene;
    scene.film.width = width;
    scene.film.height = height;
    return scene;
}

/// A triangulated torus about +y with interpolated normals.
inline std::shared_ptr<const TriangleMesh> torus_mesh(unsigned rings = 24, unsigned sides = 12) {
    auto mesh = std::make_shared<TriangleMesh>();
    for (unsigned i = 0; i < rings; ++i) {
        for (unsigned j = 0; j < sides; ++j) {
            const float a = 2 * kPi * static_cast<float>(i) / static_cast<float>(rings);
            const float b = 2 * kPi * static_cast<float>(j) / static_cast<float>(sides);
            const Vec3 normal(std::cos(b) * std::cos(a), std::sin(b), std::cos(b) * std::sin(a));
            mesh->positions.push_back(Vec3(std::cos(a), 0, std::sin(a)) + 0.35f * normal);
            mesh->normals.push_back(normal);
            mesh->bounds.extend(mesh->positions.back());
            const unsigned i1 = (i + 1) % rings, j1 = (j + 1) % sides;
            mesh->triangles.push_back({i * sides + j, i * sides + j1, i1 * sides + j1});
            mesh->triangles.push_back({i * sides + j, i1 * sides + j1, i1 * sides + j});
        }
    }
    return mesh;
}

/// Every kind of shape and material, a quad light, a sphere light and a sky.
inline Scene mixed_scene(int width, int height) {
    Scene scene = empty_scene(width, height);
    scene.camera.position = Vec3(0, 2.5f, 7);
    scene.camera.target = Vec3(0, 0.8f, 0);
    scene.environment = GradientEnvironment{Color(0.3f), Color(0.2f, 0.3f, 0.5f)};
    const MaterialId clay = add_material(scene, Diffuse{{Color(0.7f, 0.45f, 0.3f), nullptr}});
    const MaterialId gold = add_material(scene, Metal{{Color(0.9f, 0.75f, 0.45f), nullptr}, {0.3f, nullptr, 0}});
    const MaterialId mirror = add_material(scene, Metal{});
    const MaterialId glass = add_material(scene, Dielectric{});
    const MaterialId plastic = add_material(scene, Principled{.base_color = {Color(0.2f, 0.5f, 0.3f), nullptr}});
    const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(8, 7, 6), nullptr}});
    add_object(scene, Plane{}, clay);
    add_object(scene, Sphere{Vec3(-1.8f, 0.8f, 0), 0.8f}, glass);
    add_object(scene, Sphere{Vec3(0.2f, 0.6f, 1.2f), 0.6f}, gold);
    add_object(scene, Box{Vec3(1, 0, -0.5f), Vec3(2, 1.2f, 0.5f)}, plastic);
    add_object(scene, Triangle{{Vec3(-3, 0, -2), Vec3(3, 0, -2), Vec3(0, 3, -2.2f)}}, mirror);
    Transform raised;
    raised.translate = Vec3(0, 0.5f, -0.6f);
    add_object(scene, Mesh{"torus", torus_mesh()}, gold, raised);
    add_object(scene, Quad{Vec3(-1, 4, 1), Vec3(2, 0, 0), Vec3(0, 0, 1)}, lamp);
    add_object(scene, Sphere{Vec3(2.6f, 2, 1), 0.2f}, lamp);
    return scene;
}

inline std::shared_ptr<const RenderScene> make_render_scene(const Scene& scene) {
    BuildControl control;
    return RenderScene::update(nullptr, std::make_shared<const Scene>(scene), all_changes(), control);
}

/// The scene's film after `samples` samples a pixel on `threads` threads.
inline std::unique_ptr<Accumulation> render(const Scene& scene, int samples, const PathTracerOptions& options = {},
                                            int threads = 1) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    auto film = std::make_unique<Accumulation>(scene.film.width, scene.film.height);
    const std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> done{0};
    PassControl control{.cancelled = cancelled, .paths_done = done};
    arena.execute([&] {
        const auto render_scene = make_render_scene(scene);
        film->add_samples(PathTracer(*render_scene, scene.film.width, scene.film.height, options), samples, control);
    });
    return film;
}

/// A film that grows on this thread, pass by pass.
class Passes {
public:
    explicit Passes(const Scene& scene)
        : scene_(make_render_scene(scene)),
          tracer_(*scene_, scene.film.width, scene.film.height),
          film_(scene.film.width, scene.film.height) {}

    Accumulation& film() { return film_; }
    /// Until every pixel has so many samples.
    void render_to(int samples) {
        PassControl control{.cancelled = cancelled_, .paths_done = done_};
        film_.add_samples(tracer_, samples, control);
    }

private:
    std::shared_ptr<const RenderScene> scene_;
    PathTracer tracer_;
    Accumulation film_;
    const std::atomic<bool> cancelled_{false};
    std::atomic<std::uint64_t> done_{0};
};

/// The means of all pixels, to be compared bit by bit.
inline std::vector<Vec3d> means(const Film& film) {
    std::vector<Vec3d> result;
    for (std::size_t i = 0; i < static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height()); ++i) {
        result.push_back(film.mean(i));
    }
    return result;
}

/// Largest difference of a channel from that of the other image times the factor, as a share of it.
inline double difference(const Image& image, const Image& other, const Color& factor = Color(1)) {
    double largest = image.pixels.size() == other.pixels.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < std::min(image.pixels.size(), other.pixels.size()); ++i) {
        const Vec3d a(image.pixels[i]), b = Vec3d(other.pixels[i]) * Vec3d(factor);
        for (int c = 0; c < 3; ++c) {
            if (a[c] != b[c]) largest = std::max(largest, std::abs(a[c] / b[c] - 1));
        }
    }
    return largest;
}

/// What a session shows must be the image of a fresh start: to the bit, or but for rounding where the light was edited.
inline bool is_fresh(const Frame& shown, const Frame& fresh) {
    return shown.statistics.relit == 0 ? shown.image.pixels == fresh.image.pixels
                                       : difference(shown.image, fresh.image) < 1e-5;
}

/// Mean over all pixels, and over those between the given fractions of the film's width.
struct Estimate {
    double mean = 0, variance = 0;  ///< Of the luminance, and of that mean.
};
inline Estimate estimate(const Film& film, double from = 0, double to = 1) {
    Estimate sum;
    double count = 0;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = static_cast<int>(from * film.width()); x < static_cast<int>(to * film.width()); ++x) {
            const auto pixel = static_cast<std::size_t>(y * film.width() + x);
            const Vec3d mean = film.mean(pixel);
            sum.mean += 0.2126 * mean.x + 0.7152 * mean.y + 0.0722 * mean.z;
            sum.variance += film.variance_of_mean(pixel);
            ++count;
        }
    }
    return {sum.mean / count, sum.variance / (count * count)};
}

}  // namespace rayuela::testing
