#include "app/bench_meshes.h"

#include "core/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace rayuela {
namespace {

class MeshSketch {
public:
    std::uint32_t add_vertex(const Vec3& p) {
        mesh_.positions.push_back(p);
        mesh_.bounds.extend(p);
        return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
    }
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.emplace_back(a, b, c); }
    void add_quad(const Vec3& corner, const Vec3& u, const Vec3& v) {
        const std::uint32_t a = add_vertex(corner), b = add_vertex(corner + u), c = add_vertex(corner + u + v),
                            d = add_vertex(corner + v);
        add_triangle(a, b, c);
        add_triangle(a, c, d);
    }
    /// Rows x columns of quads over the points of `surface(s, t)`, s and t in [0, 1].
    template <typename Surface>
    void add_grid(std::uint32_t rows, std::uint32_t columns, const Surface& surface) {
        const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
        for (std::uint32_t i = 0; i <= rows; ++i) {
            for (std::uint32_t j = 0; j <= columns; ++j) {
                add_vertex(surface(static_cast<float>(i) / static_cast<float>(rows),
                                   static_cast<float>(j) / static_cast<float>(columns)));
            }
        }
        for (std::uint32_t i = 0; i < rows; ++i) {
            for (std::uint32_t j = 0; j < columns; ++j) {
                const std::uint32_t a = first + i * (columns + 1) + j, b = a + columns + 1;
                add_triangle(a, b, b + 1);
                add_triangle(a, b + 1, a + 1);
            }
        }
    }
    void add_room(const Vec3& lo, const Vec3& hi) {
        const Vec3 e = hi - lo, x(e.x, 0, 0), y(0, e.y, 0), z(0, 0, e.z);
        add_quad(lo, x, z);
        add_quad(lo + y, z, x);
        add_quad(lo, y, x);
        add_quad(lo + z, x, y);
        add_quad(lo, z, y);
        add_quad(lo + x, y, z);
    }
    std::shared_ptr<const TriangleMesh> finish() { return std::make_shared<TriangleMesh>(std::move(mesh_)); }

private:
    TriangleMesh mesh_;
};

Vec3 on_sphere(float s, float t) {
    const float theta = kPi * s, phi = 2 * kPi * t;
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

/// A ball with spikes, folds and hollows, so that rays have something to pass by.
std::shared_ptr<const TriangleMesh> make_ball_in_box() {
    MeshSketch sketch;
    sketch.add_room(Vec3(-2, -1.7f, -2), Vec3(2, 2.3f, 4.5f));
    sketch.add_grid(187, 187, [](float s, float t) {
        const Vec3 p = on_sphere(s, t);
        const float bumps = std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(7 * p.z + 2);
        return p * (1 + 0.5f * bumps + 0.03f * std::sin(60 * p.x) * std::cos(70 * p.y));
    });
    return sketch.finish();
}

/// Columns whose flutes run from floor to ceiling in one quad each, and long thin leaves in all directions between them.
std::shared_ptr<const TriangleMesh> make_hall() {
    MeshSketch sketch;
    sketch.add_room(Vec3(-10, 0, -6), Vec3(10, 5, 6));
    constexpr std::uint32_t kFlutes = 1500;
    for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 8; ++column) {
            const Vec3 foot(-8.4f + 2.4f * static_cast<float>(column), 0, row == 0 ? -3.0f : 3.0f);
            sketch.add_grid(8, kFlutes, [&](float s, float t) {
                const float swell = 1 + 0.3f * std::pow(2 * s - 1, 4.0f) + 0.04f * std::sin(2 * kPi * 24 * t);
                const float phi = 2 * kPi * t;
                return foot + Vec3(0.35f * swell * std::cos(phi), 5 * s, 0.35f * swell * std::sin(phi));
            });
        }
    }
    std::mt19937 random(7);
    const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    for (int leaf = 0; leaf < 46'000; ++leaf) {
        const Vec3 root(20 * uniform() - 10, 2.5f * uniform(), 12 * uniform() - 6);
        const Vec3 along = sample_uniform_cone({uniform(), uniform()}, 2) * (0.3f + 0.5f * uniform());
        const Vec3 across = sample_uniform_cone({uniform(), uniform()}, 2) * 0.006f;
        const std::uint32_t a = sketch.add_vertex(root), b = sketch.add_vertex(root + across),
                            c = sketch.add_vertex(root + along);
        sketch.add_triangle(a, b, c);
    }
    return sketch.finish();
}

/// Open land of n x n quads.
std::shared_ptr<const TriangleMesh> make_land(std::uint32_t quads_a_side) {
    MeshSketch sketch;
    sketch.add_grid(quads_a_side, quads_a_side, [](float s, float t) {
        const float x = 20 * s - 10, z = 20 * t - 10;
        float height = 0, size = 1, frequency = 0.6f;
        for (int octave = 0; octave < 9; ++octave) {
            height += size * (1 - 2 * std::fabs(std::sin(frequency * x + 1.3f * std::sin(frequency * z))));
            height += 0.5f * size * std::cos(frequency * (0.8f * z - 0.6f * x));
            size *= 0.48f;
            frequency *= 2.03f;
        }
        return Vec3(x, 0.7f * height, z);
    });
    return sketch.finish();
}

}  // namespace

BenchMesh bench_land(std::string name, std::size_t triangles) {
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 2)));
    return {.name = std::move(name),
            .description = "open displaced land",
            .make = [side] { return make_land(std::max(side, 1u)); },
            .eye = {9, 4, 9},
            .target = {0, 0, 0},
            .field_of_view = 45,
            .light_corner = {-4, 12, -2},
            .light_u = {2, 0, 0},
            .light_v = {0, 0, 2}};
}

std::vector<BenchMesh> bench_meshes() {
    const Vec3 x(1, 0, 0), z(0, 0, 1);
    return {
        {"box70k",
         "70k triangles in a closed box",
         make_ball_in_box,
         {0, 0.4f, 4},
         {0, 0, 0},
         50,
         {-0.5f, 2.2f, -0.5f},
         x,
         z},
        {"hall430k",
         "430k in a hall: columns of slivers, long thin leaves",
         make_hall,
         {-9, 1.8f, 0.3f},
         {0, 1.5f, 0},
         60,
         {-2, 4.9f, -1},
         4.0f * x,
         2.0f * z},
        bench_land("land1m", 1'000'000),
        bench_land("land6m", 6'000'000),
    };
}

}  // namespace rayuela
