#include "core/io/ply_reader.h"
#include "tests/stress/stress.h"
#include "tests/support/hits.h"
#include "tests/support/oracle.h"
#include "tests/support/scalar_list.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

/// Both splits and a few leaf sizes against the list, with rays at the primitives.
void expect_right_hits(const std::vector<GeometryInstance>& scene, const std::vector<int>& leaf_sizes, Random& random,
                       int rays, Outcome& outcome) {
    const auto list = scalar_list(scene);
    std::vector<Ray> batch;
    while (batch.size() < static_cast<std::size_t>(rays)) batch.push_back(make_ray(scene, random));
    const Answers expected = trace(*list, batch);
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        for (const int leaf_size : leaf_sizes) {
            const auto kd = build(scene, {.leaf_size = leaf_size, .split = split});
            const Answers actual = trace(*kd, batch);
            outcome.cases += batch.size();
            for (std::size_t i = 0; i < batch.size(); ++i) {
                const Hit &e = expected.hits[i], &a = actual.hits[i];
                outcome.expect(identical(a, e) && actual.blocked[i] == expected.blocked[i], [&] {
                    return fmt::format(
                        "leaf size {}: list t {:.9g} object {} primitive {}, kd t {:.9g} object {} primitive {}: {}",
                        leaf_size, e.t, e.object, e.primitive, a.t, a.object, a.primitive, describe(batch[i]));
                });
            }
        }
    }
}

MeshPtr identical_triangles(std::uint32_t count) {
    return make_mesh({Vec3(0), Vec3(1, 0, 0.3f), Vec3(0, 1, 0.1f)}, std::vector<glm::uvec3>(count, {0, 1, 2}));
}

MeshPtr random_triangles(std::uint32_t count) {
    Random random(15);
    std::vector<Vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 p = random.in_cube();
        positions.insert(positions.end(), {p, p + random.in_cube(0.05f), p + random.in_cube(0.05f)});
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

/// Figure: build time over that of as many triangles at random places.
Outcome identical_triangles_build(double scale) {
    Outcome outcome;
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        for (std::uint32_t count = 1; count <= scaled(1e5, scale, 10'000); count *= 10) {
            const GeometryInstance same{identical_triangles(count), {}}, other{random_triangles(count), {}};
            double ratio = INFINITY;
            for (int i = 0; i < 5 && count >= 1000; ++i) {
                const double same_seconds = build({same}, {.split = split})->stats().build_seconds;
                ratio = std::min(ratio, same_seconds / build({other}, {.split = split})->stats().build_seconds);
            }
            if (count >= 1000) outcome.measure(ratio);
            const auto kd = build({same}, {.split = split});
            outcome.expect(kd->stats().references <= 2 * std::uint64_t{count} + 2,
                           [&] { return fmt::format("{} references of {} triangles", kd->stats().references, count); });
            const Hit hit = intersect(*kd, {.origin = Vec3(0.2f, 0.3f, 1), .direction = Vec3(0, 0, -1)});
            outcome.expect(hit.valid() && hit.primitive == 0, [&] { return fmt::format("{} triangles", count); });
            ++outcome.cases;
        }
    }
    return outcome;
}

/// Flat, line, point, single and empty, from 1e-38 to 1e30.
Outcome degenerate_scenes(double scale) {
    return for_batches(
        scaled(2000, scale, 8), 16, 1, [](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
            constexpr std::array kSizes{1e-38f, 1e-30f, 1e-12f, 1.0f, 1e6f, 1e15f};
            const float size = kSizes[static_cast<std::size_t>(random.integer(0, int(kSizes.size()) - 1))];
            Vec3 extent(size);
            const auto kind = number % 6;
            for (std::uint64_t i = 0; i < kind && i < 3; ++i) extent[static_cast<int>((number / 6 + i) % 3)] = 0;
            std::vector<Vec3> positions;
            std::vector<glm::uvec3> triangles;
            const std::uint32_t count = kind == 4 ? 1 : kind == 5 ? 0 : 200;
            for (std::uint32_t i = 0; i < count; ++i) {
                const Vec3 p = extent * random.in_cube();
                positions.insert(positions.end(),
                                 {p, p + 0.3f * extent * random.in_cube(), p + 0.3f * extent * random.in_cube()});
                triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
            }
            std::vector<GeometryInstance> scene;
            if (count > 0) scene.push_back({make_mesh(positions, triangles), {}});
            if (random.integer(0, 1)) scene.push_back({Box{Vec3(0), extent}, {}});
            outcome.cases -= 1;
            const auto list = scalar_list(scene);
            std::vector<Ray> rays;
            for (int i = 0; i < 200; ++i) {
                Ray ray{.origin = 3 * size * random.in_cube()};
                const Vec3 target = positions.empty() ? Vec3(0) : positions[random.bits() % positions.size()];
                ray.direction = random.integer(0, 1) ? target - ray.origin : random.direction();
                if (random.integer(0, 3) == 0) ray.origin = target;
                if (ray.direction != Vec3(0)) rays.push_back(ray);
            }
            const Answers expected = trace(*list, rays);
            for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
                const auto kd = build(scene, {.leaf_size = 2, .split = split});
                const Answers actual = trace(*kd, rays);
                outcome.cases += rays.size();
                for (std::size_t i = 0; i < rays.size(); ++i) {
                    outcome.expect(identical(actual.hits[i], expected.hits[i]) && !std::isnan(actual.hits[i].t),
                                   [&] { return fmt::format("kind {} size {:g}: {}", kind, size, describe(rays[i])); });
                }
            }
        });
}

/// Binary PLY of random bits; one index in 32 is out of range.
std::string garbage_ply(Random& random, bool bad_indices) {
    const auto vertices = static_cast<std::uint32_t>(random.integer(3, 60)),
               faces = static_cast<std::uint32_t>(random.integer(1, 60));
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices, faces);
    const auto append = [&](std::uint32_t word) { bytes.append(reinterpret_cast<const char*>(&word), 4); };
    for (std::uint32_t i = 0; i < 3 * vertices; ++i) {
        float x = std::bit_cast<float>(random.bits());
        while (!std::isfinite(x)) x = std::bit_cast<float>(random.bits());
        append(std::bit_cast<std::uint32_t>(x));
    }
    for (std::uint32_t i = 0; i < faces; ++i) {
        bytes.push_back(3);
        for (int corner = 0; corner < 3; ++corner)
            append(bad_indices && random.integer(0, 31) == 0 ? random.bits() : random.bits() % vertices);
    }
    return bytes;
}

/// Refused by the reader, or built and traced like the list; sanitizers watch the rest.
Outcome garbage_meshes(double scale) {
    return for_batches(scaled(1000, scale, 4), 17, 1,
                       [](Random& random, std::uint64_t, std::uint64_t, Outcome& outcome) {
                           std::vector<GeometryInstance> scene;
                           for (int i = 0; i < 20; ++i) {
                               const auto mesh = parse_ply(garbage_ply(random, i % 4 == 0), "garbage.ply");
                               if (mesh) scene.push_back({*mesh, {}});
                           }
                           outcome.cases -= 1;
                           expect_right_hits(scene, {16}, random, 400, outcome);
                       });
}

/// Coordinates whose planes lie an ulp apart, and clusters of a millionth beside some at 1e30.
Outcome near_ties_and_clusters(double scale) {
    return for_batches(
        scaled(1000, scale, 4), 18, 1, [](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
            constexpr std::array kTies{-6.4000024f, -6.4f, 25.6f, 25.600002f, 34.0f, 57.6f, 57.6000022f};
            const auto tie = [&] { return kTies[static_cast<std::size_t>(random.integer(0, int(kTies.size()) - 1))]; };
            const bool clusters = number % 2 == 1;
            std::vector<Vec3> positions;
            std::vector<glm::uvec3> triangles;
            for (std::uint32_t i = 0; i < 200; ++i) {
                const Vec3 far(random.integer(0, 9) == 0 ? 1e30f : 0.0f, 0, random.integer(0, 19) == 0 ? -1e30f : 0.0f);
                const Vec3 p = clusters ? far + 1e-6f * random.in_cube() : Vec3(tie(), tie(), tie());
                for (int corner = 0; corner < 3; ++corner)
                    positions.push_back(clusters ? p + 1e-6f * random.in_cube() : Vec3(tie(), tie(), tie()));
                triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
            }
            outcome.cases -= 1;
            expect_right_hits({{make_mesh(std::move(positions), std::move(triangles)), {}}}, {1, 4, 16, kMaxLeafSize},
                              random, 100, outcome);
        });
}

}  // namespace

std::vector<StressTest> kd_build_tests() {
    return {
        {15, "identical triangles: build time, references, hits", "times random ones", 4, identical_triangles_build},
        {16, "flat, line, point, single, empty; 1e-38 to 1e15", "differences", 0, degenerate_scenes},
        {17, "garbage meshes: refused, or traced as the list does", "differences", 0, garbage_meshes},
        {18, "near-tie planes; clusters beside 1e30 (19)", "differences", 0, near_ties_and_clusters}};
}

}  // namespace rayuela::stress
