#pragma once

#include "core/accel/accelerator.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <random>

/// Scenes and rays for tests of the accelerators. All random, all reproducible from a seed.
namespace rayuela::test {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    float uniform(float lo = 0, float hi = 1) { return std::uniform_real_distribution<float>(lo, hi)(engine_); }
    int integer(int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(engine_); }
    std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }
    Vec3 in_cube(float half = 1) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    Vec3 direction() {
        while (true) {
            const Vec3 v = in_cube();
            const float length = glm::length(v);
            if (length > 0.01f && length <= 1) return v / length;
        }
    }
    Mat3 rotation() { return Mat3(glm::rotate(Mat4(1), uniform(0, 6.2831853f), direction())); }

private:
    std::mt19937_64 engine_;
};

using MeshPtr = std::shared_ptr<const TriangleMesh>;

inline MeshPtr make_mesh(std::vector<Vec3> positions, std::vector<glm::uvec3> triangles) {
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = std::move(positions);
    mesh->triangles = std::move(triangles);
    for (const Vec3& p : mesh->positions) mesh->bounds.extend(p);
    return mesh;
}

/// Closed ball of 2 * rings * (rings - 1) * 2 triangles, its vertices moved off the sphere by up to `jitter` radii.
inline MeshPtr make_ball(int rings, float radius, const Vec3& center, float jitter, std::uint64_t seed) {
    Random random(seed);
    const int segments = 2 * rings;
    std::vector<Vec3> positions{center + Vec3(0, radius, 0)};
    for (int r = 1; r < rings; ++r) {
        for (int s = 0; s < segments; ++s) {
            const float theta = kPi * static_cast<float>(r) / static_cast<float>(rings);
            const float phi = 2 * kPi * static_cast<float>(s) / static_cast<float>(segments);
            const Vec3 n(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            positions.push_back(center + radius * n * (1 + random.uniform(-jitter, jitter)));
        }
    }
    positions.push_back(center - Vec3(0, radius, 0));
    const auto at = [&](int r, int s) { return static_cast<std::uint32_t>(1 + (r - 1) * segments + s % segments); };
    const auto last = static_cast<std::uint32_t>(positions.size() - 1);
    std::vector<glm::uvec3> triangles;
    for (int s = 0; s < segments; ++s) {
        triangles.push_back({0, at(1, s + 1), at(1, s)});
        triangles.push_back({last, at(rings - 1, s), at(rings - 1, s + 1)});
        for (int r = 1; r + 1 < rings; ++r) {
            triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
            triangles.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
        }
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

/// Unconnected triangles: small ones, slivers, axis-aligned and degenerate ones.
inline MeshPtr make_soup(int count, Random& random) {
    std::vector<Vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (int i = 0; i < count; ++i) {
        const Vec3 p = random.in_cube();
        Vec3 a = random.in_cube(0.1f), b = random.in_cube(0.1f);
        const int kind = random.integer(0, 9);
        if (kind == 0) a = a * 15.0f, b = a * 1.00001f + Vec3(1e-5f);
        if (kind == 1) a[random.integer(0, 2)] = b[random.integer(0, 2)] = 0;
        if (kind == 2) a[0] = b[0] = 0;
        if (kind == 3) b = a;
        const auto first = static_cast<std::uint32_t>(positions.size());
        positions.insert(positions.end(), {p, p + a, p + b});
        triangles.push_back({first, first + 1, first + 2});
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

/// A wavy grid over [-1, 1]^2 whose vertices lie on multiples of 1/cells, flat where `height` is 0.
inline MeshPtr make_grid(int cells, float height) {
    std::vector<Vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const float x = 2 * static_cast<float>(i) / static_cast<float>(cells) - 1;
            const float z = 2 * static_cast<float>(j) / static_cast<float>(cells) - 1;
            positions.push_back({x, height * std::sin(5 * x) * std::cos(4 * z), z});
        }
    }
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (cells + 1) + i),
                       b = a + static_cast<std::uint32_t>(cells) + 1;
            triangles.push_back({a, b, a + 1});
            triangles.push_back({a + 1, b, b + 1});
        }
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

inline Affine random_transform(Random& random) {
    const Vec3 move = random.in_cube(2);
    switch (random.integer(0, 5)) {
        case 0:
            return {};
        case 1:
            return {Mat3(1), move};
        case 2:
            return {random.rotation() * random.uniform(0.3f, 2.0f), move};
        case 3: {
            Mat3 scale(1);
            for (int i = 0; i < 3; ++i) scale[i][i] = random.uniform(0.2f, 2.0f);
            return {scale, move};
        }
        case 4: {
            Mat3 scale(1);
            for (int i = 0; i < 3; ++i)
                scale[i][i] = random.uniform(0.2f, 2.0f) * (random.integer(0, 1) ? 1.0f : -1.0f);
            return {random.rotation() * scale, move};
        }
        default: {
            Mat3 any(1);
            for (int i = 0; i < 3; ++i) any[i] += random.in_cube(0.5f);
            return {any, move};
        }
    }
}

/// All shapes, all kinds of transforms, meshes instanced several times.
inline std::vector<GeometryInstance> make_scene(std::uint64_t seed, int objects, int triangles) {
    Random random(seed);
    const std::vector<MeshPtr> meshes{make_ball(6, 1, Vec3(0), 0.2f, seed), make_soup(triangles, random),
                                      make_grid(8, random.integer(0, 1) ? 0.3f : 0.0f)};
    std::vector<GeometryInstance> instances;
    for (int i = 0; i < objects; ++i) {
        TracedShape shape;
        switch (random.integer(0, 8)) {
            case 0:
            case 1:
                shape = Sphere{random.in_cube(3), random.uniform(0.05f, 1.0f)};
                break;
            case 2: {
                const Vec3 a = random.in_cube(2), size = glm::abs(random.in_cube(1));
                shape = Box{a, a + (random.integer(0, 4) ? size : size * Vec3(1, 0, 1))};
                break;
            }
            case 3:
                shape = Triangle{{random.in_cube(2), random.in_cube(2), random.in_cube(2)}};
                break;
            case 4:
                shape = Quad{random.in_cube(2), random.in_cube(1), random.in_cube(1)};
                break;
            case 5:
                if (random.integer(0, 3) == 0) {
                    shape = Plane{random.in_cube(4), random.direction()};
                    break;
                }
                [[fallthrough]];
            default:
                shape = meshes[static_cast<std::size_t>(random.integer(0, 2))];
                break;
        }
        instances.push_back({shape, random_transform(random)});
    }
    return instances;
}

/// A point that matters to the tree: a vertex, a corner, a centre.
inline Vec3 special_point(const std::vector<GeometryInstance>& instances, Random& random) {
    if (instances.empty()) return random.in_cube();
    const GeometryInstance& instance =
        instances[static_cast<std::size_t>(random.integer(0, static_cast<int>(instances.size()) - 1))];
    const auto point = [&](const auto& shape) -> Vec3 {
        using T = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<T, Sphere>) {
            return shape.center + (random.integer(0, 1) ? Vec3(shape.radius, 0, 0) : Vec3(0));
        } else if constexpr (std::is_same_v<T, Box>) {
            return {random.integer(0, 1) ? shape.min.x : shape.max.x, random.integer(0, 1) ? shape.min.y : shape.max.y,
                    random.integer(0, 1) ? shape.min.z : shape.max.z};
        } else if constexpr (std::is_same_v<T, Triangle>) {
            return shape.vertices[static_cast<std::size_t>(random.integer(0, 2))];
        } else if constexpr (std::is_same_v<T, MeshPtr>) {
            const glm::uvec3 t = shape->triangles[random.bits() % shape->triangles.size()];
            const Vec3 &a = shape->positions[t.x], &b = shape->positions[t.y];
            return random.integer(0, 1) ? a : 0.5f * (a + b);
        } else {
            return shape.point;
        }
    };
    return instance.to_world.point(std::visit(point, instance.shape));
}

/// Random, aimed at special points, along an axis with a special point's coordinates (origins in split planes, rays within
/// faces), with zero components, leaving a special point; with and without limits.
inline Ray make_ray(const std::vector<GeometryInstance>& instances, Random& random) {
    Ray ray;
    ray.origin = random.in_cube(5);
    ray.direction = random.direction();
    switch (random.integer(0, 7)) {
        case 0:
            break;
        case 1:
            ray.direction = special_point(instances, random) - ray.origin;
            break;
        case 2: {
            const int axis = random.integer(0, 2);
            ray.origin = special_point(instances, random);
            ray.origin[axis] += random.uniform(-6, 6);
            ray.direction = Vec3(0);
            ray.direction[axis] = random.integer(0, 1) ? 1.0f : -1.0f;
            break;
        }
        case 3: {
            const int axis = random.integer(0, 2);
            ray.origin[axis] = special_point(instances, random)[axis];
            ray.direction[axis] = random.integer(0, 1) ? 0.0f : -0.0f;
            break;
        }
        case 4:
            ray.origin = special_point(instances, random);
            break;
        case 5: {
            const Vec3 from = special_point(instances, random);
            ray.direction = special_point(instances, random) - from;
            ray.origin = from - ray.direction;
            break;
        }
        case 6:
            ray.direction *= random.uniform(1e-3f, 1e3f);
            break;
        default:
            ray.origin *= random.uniform(1, 100);
            break;
    }
    if (ray.direction == Vec3(0)) ray.direction = Vec3(0, 0, 1);
    if (random.integer(0, 3) == 0) ray.t_min = random.uniform(0, 3);
    if (random.integer(0, 3) == 0) ray.t_max = random.uniform(0.5f, 8);
    return ray;
}

inline std::shared_ptr<const Accelerator> build(std::vector<GeometryInstance> instances,
                                                const AccelSettings& settings) {
    BuildControl control;
    return Accelerator::build(std::move(instances), settings, nullptr, control);
}

inline Hit intersect(const Accelerator& accelerator, const Ray& ray) {
    Hit hit;
    accelerator.intersect({&ray, 1}, {&hit, 1});
    return hit;
}

}  // namespace rayuela::test
