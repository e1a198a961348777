#include "core/accel/kd_accelerator.h"
#include "core/math/float_error.h"
#include "tests/stress/stress.h"
#include "tests/support/hits.h"
#include "tests/support/oracle.h"
#include "tests/support/scalar_list.h"

#include <fmt/format.h>

#include <array>
#include <ctime>
#include <numeric>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

constexpr std::array kLeafSizes{1, 2, 3, 4, 8, 16, 64, kMaxLeafSize};

using Rays = std::vector<Ray>;
using Scene = std::vector<GeometryInstance>;

/// The list's hits and those of a tree, bit for bit, and `occluded` against `intersect`.
void expect_identical(const Accelerator& kd, const Rays& rays, const Answers& expected, Outcome& outcome) {
    const Answers actual = trace(kd, rays);
    outcome.cases += rays.size();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit &e = expected.hits[i], &a = actual.hits[i];
        outcome.expect(identical(e, a) && actual.blocked[i] == (e.valid() ? 1 : 0), [&] {
            return fmt::format(
                "leaf size {}: list t {:.9g} object {} primitive {}, kd t {:.9g} object {} primitive {}: {}",
                kd.settings().leaf_size, e.t, e.object, e.primitive, a.t, a.object, a.primitive, describe(rays[i]));
        });
    }
}

/// Every leaf size and both splits on batches of rays made by make(random); `count` rays in all.
template <typename Make>
Outcome against_list(const Scene& scene, std::uint64_t count, std::uint64_t seed, const Make& make) {
    const auto list = scalar_list(scene);
    std::vector<std::shared_ptr<const Accelerator>> trees;
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        for (const int leaf_size : kLeafSizes) trees.push_back(build(scene, {.leaf_size = leaf_size, .split = split}));
    }
    Outcome total =
        for_batches(count, seed, 512, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            Rays rays;
            while (rays.size() < n) rays.push_back(make(random));
            outcome.cases -= n;
            const Answers expected = trace(*list, rays);
            for (const auto& tree : trees) expect_identical(*tree, rays, expected, outcome);
        });
    return total;
}

/// Random, vertex-aimed, axis-parallel in split planes, within faces: see make_ray.
Outcome random_scenes(double scale) {
    Outcome total;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        // Few objects, which no tree holds unless it is the median's, and a crowd.
        const int objects = seed % 5 == 4 ? 2 * static_cast<int>(kFewObjects) : static_cast<int>(4 + 2 * seed);
        Scene scene = make_scene(500 + seed, objects, 60 + 10 * static_cast<int>(seed % 5));
        // It stands apart from the tree over a crowd.
        if (seed % 2 == 0) scene.push_back({Sphere{Vec3(0, -200, 0), 198}, {}});
        total.add(against_list(scene, scaled(1e7 / 20 / 16, scale), 2100 + seed,
                               [&](Random& random) { return make_ray(scene, random); }));
    }
    return total;
}

Outcome lattices(double scale) {
    Scene scene{{make_grid(16, 0), {}}, {make_grid(8, 0), {Mat3(1), Vec3(0, 0.5f, 0)}}};
    for (int i = -2; i < 2; ++i) {
        const auto x = static_cast<float>(i);
        scene.push_back({Box{Vec3(x, -1, -1), Vec3(x + 1, 0, 0)}, {}});
        scene.push_back({Quad{Vec3(x, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {}});
        scene.push_back({Triangle{{Vec3(x, 0, 0), Vec3(x, 1, 0), Vec3(x, 0, 1)}}, {}});
    }
    return against_list(scene, scaled(1e7 / 16, scale), 2200, [](Random& random) {
        const auto lattice = [&] {
            return Vec3(random.integer(-16, 16), random.integer(-16, 16), random.integer(-16, 16)) / 8.0f;
        };
        while (true) {
            Ray ray{.origin = lattice()};
            ray.direction = lattice() - ray.origin;
            if (random.integer(0, 1)) ray.direction[random.integer(0, 2)] = 0;
            if (random.integer(0, 1)) ray.direction[random.integer(0, 2)] = 0;
            if (ray.direction != Vec3(0)) return ray;
        }
    });
}

/// One tree's two answers.
Outcome occluded_is_a_hit(double scale) {
    Outcome total;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Scene scene = make_scene(600 + seed, 30, 200);
        const auto kd = build(scene, {.leaf_size = 1 + static_cast<int>(seed)});
        total.add(for_batches(scaled(1e7, scale), 2300 + seed, 1024,
                              [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
                                  Rays rays;
                                  while (rays.size() < n) rays.push_back(make_ray(scene, random));
                                  const Answers answers = trace(*kd, rays);
                                  for (std::size_t i = 0; i < n; ++i) {
                                      outcome.expect(answers.blocked[i] == (answers.hits[i].valid() ? 1 : 0),
                                                     [&] { return describe(rays[i]); });
                                  }
                              }));
    }
    return total;
}

/// With t_max (t_min) the t of the hit it is there, one ulp before (behind) it is not.
Outcome inclusive_ends(double scale) {
    const Scene scene = make_scene(11, 20, 100);
    const auto kd = build(scene, {.leaf_size = 4});
    return for_cases(scaled(1e7, scale), 24, [&](Random& random, Outcome& outcome) {
        Ray ray = make_ray(scene, random);
        const Hit hit = intersect(*kd, ray);
        if (!hit.valid()) return;
        const auto where = [&] { return describe(ray); };
        const auto with = [&](float t_min, float t_max) {
            Ray limited = ray;
            limited.t_min = t_min;
            limited.t_max = t_max;
            return intersect(*kd, limited);
        };
        outcome.expect(identical(with(ray.t_min, hit.t), hit), where);
        outcome.expect(identical(with(ray.t_min, next_up(hit.t)), hit), where);
        outcome.expect(identical(with(hit.t, ray.t_max), hit), where);
        outcome.expect(!(with(ray.t_min, next_down(hit.t)).valid()), where);
        const Hit behind = with(next_up(hit.t), ray.t_max);
        outcome.expect(!behind.valid() || behind.t > hit.t, where);
    });
}

/// p[axis[k]] * sign[k] as component k.
struct AxisPermutation {
    std::array<int, 3> axis{0, 1, 2};
    Vec3 sign{1};

    Vec3 operator()(const Vec3& p) const { return sign * Vec3(p[axis[0]], p[axis[1]], p[axis[2]]); }
    std::uint32_t face(std::uint32_t f) const {
        const auto k = static_cast<std::uint32_t>(std::ranges::find(axis, static_cast<int>(f / 2)) - axis.begin());
        return 2 * k + (sign[static_cast<int>(k)] < 0 ? 1 - f % 2 : f % 2);
    }
};

std::vector<AxisPermutation> axis_permutations() {
    std::vector<AxisPermutation> all;
    std::array<int, 3> axis{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs)
            all.push_back({axis, {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1}});
    } while (std::ranges::next_permutation(axis).found);
    return all;
}

GeometryInstance permuted(const GeometryInstance& instance, const AxisPermutation& p) {
    if (const auto* mesh = std::get_if<MeshPtr>(&instance.shape)) {
        std::vector<Vec3> positions;
        for (const Vec3& v : (*mesh)->positions) positions.push_back(p(v));
        return {make_mesh(std::move(positions), (*mesh)->triangles), {}};
    }
    if (const auto* sphere = std::get_if<Sphere>(&instance.shape))
        return {Sphere{p(sphere->center), sphere->radius}, {}};
    const Box& box = std::get<Box>(instance.shape);
    const Vec3 a = p(box.min), b = p(box.max);
    return {Box{glm::min(a, b), glm::max(a, b)}, {}};
}

/// The same scene and rays with axes exchanged and mirrored. A ray through an edge may meet either neighbour.
Outcome permuted_axes(double scale) {
    const Scene scene{{make_ball(8, 1, Vec3(0), 0.1f, 3), {}},
                      {Sphere{Vec3(1.5f, 0.2f, 0), 0.6f}, {}},
                      {Box{Vec3(-2, -1, -1), Vec3(-1.2f, 0.5f, 1)}, {}}};
    const auto kd = build(scene, {.leaf_size = 4});
    Outcome total;
    for (const AxisPermutation& p : axis_permutations()) {
        Scene other;
        for (const GeometryInstance& instance : scene) other.push_back(permuted(instance, p));
        const auto permuted_kd = build(other, {.leaf_size = 4});
        total.add(for_cases(scaled(1e6 / 48, scale), 25, [&](Random& random, Outcome& outcome) {
            const Ray ray = make_ray(scene, random);
            const Hit a = intersect(*kd, ray);
            const Hit b = intersect(*permuted_kd, {p(ray.origin), ray.t_min, p(ray.direction), ray.t_max});
            outcome.expect(a.valid() == b.valid(), [&] { return describe(ray); });
            if (!a.valid() || !b.valid()) return;
            outcome.measure(ulp_error(b.t, a.t));
            const bool tie = a.u == 0 || a.v == 0 || a.u + a.v >= 1 || scene[a.object].shape.index() == 2;
            const std::uint32_t primitive = a.object == 2 ? p.face(a.primitive) : a.primitive;
            outcome.expect(tie || (b.object == a.object && b.primitive == primitive), [&] { return describe(ray); });
        }));
    }
    return total;
}

/// Rays with NaN, infinite and tiny numbers miss or agree, in no more time than ordinary ones.
Outcome strange_rays(double scale) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr std::array kValues{kNan, kInfinity, -kInfinity, 0.0f, -0.0f, 1e-45f, -1e-40f, 1e-38f, 1e30f, -3e38f};
    const Scene scene = make_scene(31, 12, 400);
    const auto kd = build(scene, {}), list = scalar_list(scene);
    const auto strange = [&](Random& random) {
        Ray ray = make_ray(scene, random);
        for (int change = random.integer(1, 4); change > 0; --change) {
            const int k = random.integer(0, 7);
            const float value = kValues[static_cast<std::size_t>(random.integer(0, int(kValues.size()) - 1))];
            (k < 3 ? ray.origin[k] : k < 6 ? ray.direction[k - 3] : k == 6 ? ray.t_min : ray.t_max) = value;
        }
        return ray;
    };
    Outcome total =
        for_batches(scaled(1e6, scale), 13, 512, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            Rays rays;
            while (rays.size() < n) rays.push_back(strange(random));
            const Answers expected = trace(*list, rays);
            outcome.cases -= n;
            expect_identical(*kd, rays, expected, outcome);
            for (std::size_t i = 0; i < n; ++i) {
                const Ray& r = rays[i];
                const bool must_miss =
                    !is_finite(r.origin) || !is_finite(r.direction) || r.direction == Vec3(0) || !(r.t_min <= r.t_max);
                outcome.expect(!must_miss || !expected.hits[i].valid(), [&] { return describe(r); });
            }
        });
    Random random(13);
    Rays ordinary_rays, strange_rays;
    while (strange_rays.size() < 20'000) {
        ordinary_rays.push_back(make_ray(scene, random));
        strange_rays.push_back(strange(random));
    }
    std::vector<Hit> hits(ordinary_rays.size());
    const auto clocks = [&](const Rays& rays) {
        // Of the processor, so that other work of the machine does not count.
        const std::clock_t start = std::clock();
        kd->intersect(rays, hits);
        return static_cast<double>(std::clock() - start);
    };
    double ratio = INFINITY;
    for (int i = 0; i < 5; ++i) ratio = std::min(ratio, clocks(strange_rays) / clocks(ordinary_rays));
    total.measure(ratio);
    return total;
}

}  // namespace

std::vector<StressTest> traversal_tests() {
    return {{13, "NaN, infinite and tiny rays: miss or agree", "times ordinary rays", 1.5, strange_rays},
            {21, "kd against list, all leaf sizes and splits", "differences", 0, random_scenes},
            {22, "kd against list, lattice rays", "differences", 0, lattices},
            {23, "occluded() is intersect().valid()", "differences", 0, occluded_is_a_hit},
            {24, "t_min and t_max are inclusive to the ulp", "differences", 0, inclusive_ends},
            {25, "48 signed permutations of the axes", "ulp of t", 2, permuted_axes}};
}

}  // namespace rayuela::stress
