#include "core/accel/kd_accelerator.h"
#include "core/math/isa.h"
#include "tests/support/hits.h"
#include "tests/support/scalar_list.h"

#include <gtest/gtest.h>

namespace rayuela::test {
namespace {

::testing::AssertionResult same_answers(const Answers& expected, const Answers& actual, const std::vector<Ray>& rays) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit &e = expected.hits[i], &a = actual.hits[i];
        const Ray& r = rays[i];
        if (!identical(e, a)) {
            return ::testing::AssertionFailure()
                   << "ray " << i << " o " << r.origin.x << ' ' << r.origin.y << ' ' << r.origin.z << " d "
                   << r.direction.x << ' ' << r.direction.y << ' ' << r.direction.z << ": list t " << e.t << " object "
                   << e.object << " primitive " << e.primitive << ", kd t " << a.t << " object " << a.object
                   << " primitive " << a.primitive;
        }
        if (actual.blocked[i] != (e.valid() ? 1 : 0) || expected.blocked[i] != actual.blocked[i]) {
            return ::testing::AssertionFailure() << "ray " << i << ": occluded differs from intersect";
        }
    }
    return ::testing::AssertionSuccess();
}

std::vector<Ray> make_rays(const std::vector<GeometryInstance>& instances, int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) rays.push_back(make_ray(instances, random));
    return rays;
}

/// Rays in bundles around each of these, of all widths down to none: the kernels take those that stay together together.
std::vector<Ray> bundles(const std::vector<Ray>& around, std::uint64_t seed) {
    constexpr int kBundle = 16;
    Random random(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < around.size(); ++i) {
        const float size = glm::length(around[i].direction);
        const float width = i % 3 == 0 ? 0 : std::ldexp(1.0f, -random.integer(2, 20));
        for (int k = 0; k < kBundle; ++k) {
            Ray ray = around[i];
            ray.origin += random.in_cube(width);
            ray.direction += size * random.in_cube(width);
            if (k % 5 == 4) ray.t_max = random.uniform(0, 3);
            if (ray.direction != Vec3(0)) rays.push_back(ray);
        }
    }
    return rays;
}

void expect_same_as_list(const std::vector<GeometryInstance>& instances, const std::vector<Ray>& rays,
                         const std::vector<int>& leaf_sizes) {
    const Answers expected = trace(*scalar_list(instances), rays);
    EXPECT_TRUE(same_answers(expected, trace(*build(instances, {.kind = AcceleratorKind::list}), rays), rays))
        << "list";
    for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
        for (const int leaf_size : leaf_sizes) {
            const auto kd = build(instances, {.kind = AcceleratorKind::kd, .leaf_size = leaf_size, .split = split});
            EXPECT_TRUE(same_answers(expected, trace(*kd, rays), rays))
                << "leaf size " << leaf_size << (split == KdSplit::sah ? " sah" : " median");
        }
    }
}

TEST(KdVersusList, EachLeafSizeAndSplitGivesIdenticalHits) {
    std::vector<int> sizes;
    for (int i = 1; i <= 64; ++i) sizes.push_back(i);
    sizes.push_back(1 << 20);
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const auto instances = make_scene(seed, 24, 150);
        expect_same_as_list(instances, make_rays(instances, 2000, seed), sizes);
    }
}

/// Each tree made from the one before it.
TEST(KdVersusList, ChangesOfTheLeafSize) {
    Random random(5);
    for (std::uint64_t seed = 200; seed < 206; ++seed) {
        const auto instances = make_scene(seed, 24, 150);
        const auto rays = make_rays(instances, 1500, seed);
        const Answers expected = trace(*scalar_list(instances), rays);
        for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
            std::shared_ptr<const Accelerator> kd;
            for (int step = 0; step < 12; ++step) {
                const int leaf_size = step % 6 == 5 ? kMaxLeafSize : random.integer(1, step % 3 == 0 ? 64 : 8);
                BuildControl control;
                kd = Accelerator::build(instances, {.leaf_size = leaf_size, .split = split}, kd.get(), control);
                EXPECT_TRUE(same_answers(expected, trace(*kd, rays), rays)) << "leaf size " << leaf_size;
            }
        }
    }
}

TEST(KdVersusList, ManyScenes) {
    for (std::uint64_t seed = 100; seed < 140; ++seed) {
        const auto instances = make_scene(seed, static_cast<int>(1 + seed % 40), 60);
        expect_same_as_list(instances, make_rays(instances, 1500, seed), {1, 4, 16});
    }
}

TEST(KdVersusList, ACrowdOfObjects) {
    const auto instances = make_scene(7, 600, 30);
    expect_same_as_list(instances, make_rays(instances, 3000, 8), {1, 16, 64});
}

/// The mesh in a closed room of twelve triangles, all in one mesh.
MeshPtr in_a_room(const TriangleMesh& mesh, float half) {
    std::vector<Vec3> positions = mesh.positions;
    std::vector<glm::uvec3> triangles = mesh.triangles;
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (std::uint32_t i = 0; i < 8; ++i)
        positions.push_back(half * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t u = 1u << axis, v = 1u << (axis + 1) % 3, w = 1u << (axis + 2) % 3;
        for (const std::uint32_t side : {0u, w}) {
            triangles.emplace_back(first + side, first + side + u, first + side + u + v);
            triangles.emplace_back(first + side, first + side + u + v, first + side + v);
        }
    }
    return make_mesh(std::move(positions), std::move(triangles));
}

TEST(KdVersusList, LargeTrianglesOfAMesh) {
    Random random(21);
    const MeshPtr room = in_a_room(*make_ball(12, 1, Vec3(0.2f, 0, 0), 0.2f, 3), 1.5f);
    for (const bool alone : {true, false}) {
        std::vector<GeometryInstance> instances{{room, {}}};
        for (int i = 0; i < 6 && !alone; ++i) instances.push_back({room, random_transform(random)});
        const auto built = build(instances, {});
        const KdTree& tree = dynamic_cast<const KdAccelerator&>(*built).mesh_tree(0)->tree;
        ASSERT_NE(tree.apart, 0u);
        EXPECT_EQ(tree.nodes[tree.apart].count(), 12u);
        EXPECT_LT(tree.bounds.hi.y, 1.3f) << "the tree holds the ball alone";
        std::vector<Ray> rays = make_rays(instances, 3000, 22);
        for (const Ray& ray : bundles(make_rays(instances, 60, 23), 24)) rays.push_back(ray);
        for (const std::string_view set : instruction_sets()) {
            use_instruction_set(set);
            expect_same_as_list(instances, rays, {1, 16, 10'000});
        }
    }
    use_instruction_set(instruction_sets().front());
}

/// Through the pixels of squares of 4 x 4, 16 such squares, as a camera at the eye has them that looks along `forward`.
std::vector<Ray> camera_rays(const Vec3& eye, const Vec3& forward, float spacing) {
    const Vec3 size = glm::abs(forward);
    const Vec3 side = size.x > size.y ? Vec3(0, 1, 0) : Vec3(1, 0, 0), up = glm::cross(forward, side);
    std::vector<Ray> rays;
    for (int i = 0; i < 256; ++i) {
        const int square = i / 16, pixel = i % 16;
        const auto x = static_cast<float>(4 * (square % 4) + pixel % 4 - 8),
                   y = static_cast<float>(4 * (square / 4) + pixel / 4 - 8);
        rays.push_back({.origin = eye, .direction = forward + spacing * (x * side + y * up)});
    }
    return rays;
}

/// Rays from one point go through a tree together: along axes and not, through vertices and edges, with ends of their own, past a
/// plane, from the inside, and through meshes finer and coarser than they are.
TEST(KdVersusList, RaysOfACamera) {
    Random random(41);
    const MeshPtr ball = make_ball(12, 1, Vec3(0.2f, 0, 0), 0.2f, 42), room = in_a_room(*ball, 1.5f),
                  slivers = make_soup(200, random), grid = make_grid(16, 0);
    const std::vector<std::vector<GeometryInstance>> scenes{
        {{ball, {}}},
        {{room, {}}, {Plane{Vec3(0, -0.5f, 0), Vec3(0, 1, 0)}, {}}},
        {{slivers, {}}},
        {{grid, {}}, {ball, random_transform(random)}, {ball, random_transform(random)}}};
    const Vec3 corner = Vec3(1, 2, 3) / 8.0f;
    for (const std::vector<GeometryInstance>& scene : scenes) {
        std::vector<Ray> rays;
        for (const float spacing : {0x1p-12f, 0x1p-8f, 0x1p-7f}) {
            for (int axis = 0; axis < 3; ++axis) {
                for (const float sign : {-1.0f, 1.0f}) {
                    Vec3 forward(0);
                    forward[axis] = sign;
                    for (const Vec3& tilt : {Vec3(0), random.in_cube(0.5f)}) {
                        for (const Vec3& eye : {corner, corner - 3.0f * forward}) {
                            for (const Ray& ray : camera_rays(eye, forward + tilt, spacing)) rays.push_back(ray);
                        }
                    }
                }
            }
        }
        for (std::size_t i = 0; i < rays.size(); i += 7) rays[i].t_max = random.uniform(0, 4);
        for (std::size_t i = 3; i < rays.size(); i += 11) rays[i].t_min = random.uniform(0, 4);
        for (const std::string_view set : instruction_sets()) {
            use_instruction_set(set);
            expect_same_as_list(scene, rays, {1, 16});
        }
        use_instruction_set(instruction_sets().front());
    }
}

/// There the rounding of the float test decides: without the bound on it hits are lost.
TEST(KdVersusList, RaysFromOnePointAtVerticesAndEdges) {
    Random random(51);
    for (int view = 0; view < 24; ++view) {
        const MeshPtr ball = make_ball(12, 1, random.in_cube(1), 0.2f, 52);
        const Vec3 eye = 20.0f * glm::normalize(random.in_cube(1));
        std::vector<Ray> rays;
        for (const glm::uvec3& t : ball->triangles) {
            const Vec3 a = ball->positions[t.x], b = ball->positions[t.y];
            rays.push_back({.origin = eye, .direction = a - eye});
            rays.push_back({.origin = eye, .direction = 0.5f * (a + b) - eye});
        }
        for (const std::string_view set : instruction_sets()) {
            use_instruction_set(set);
            expect_same_as_list({{ball, {}}}, rays, {1, 16});
        }
        use_instruction_set(instruction_sets().front());
    }
}

/// What a mesh's tree holds lies behind the ray, farther than any float.
TEST(KdVersusList, ALargeTriangleAheadOfARayThatHasLeftTheTree) {
    const MeshPtr ball = make_ball(12, 1, Vec3(0), 0.2f, 3);
    std::vector<Vec3> positions = ball->positions;
    std::vector<glm::uvec3> triangles = ball->triangles;
    triangles.push_back(static_cast<std::uint32_t>(positions.size()) + glm::uvec3(0, 1, 2));
    positions.insert(positions.end(), {Vec3(-4.1903353e18f, -6.72909388e32f, -0.47637853f),
                                       Vec3(6.32640347e-19f, 7.98971314e-07f, -4.15667896e10f),
                                       Vec3(1.56955338e37f, 0.514992893f, -1.14992277e38f)});
    const std::vector<GeometryInstance> instances{{make_mesh(std::move(positions), std::move(triangles)), {}}};
    const auto built = build(instances, {});
    ASSERT_EQ(dynamic_cast<const KdAccelerator&>(*built).mesh_tree(0)->tree.nodes.back().count(), 1u);
    const Ray ray{.origin = Vec3(7.8477669e36f, 0.257496446f, -5.74961387e37f),
                  .direction = Vec3(-0.0778928995f, 0.991512358f, -0.10409674f)};
    ASSERT_TRUE(intersect(*scalar_list(instances), ray).valid());
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        expect_same_as_list(instances, {ray}, {1, 16});
    }
    use_instruction_set(instruction_sets().front());
}

TEST(KdVersusList, LargeObjectsBesideACrowd) {
    auto instances = make_scene(9, 300, 30);
    Mat3 flattened(1);
    flattened[1][1] = 0.01f;
    instances.push_back({Sphere{Vec3(0, -200, 0), 197}, {}});
    instances.push_back({Quad{Vec3(-8, -4, -8), Vec3(16, 0, 0), Vec3(0, 0, 16)}, {}});
    instances.push_back({Triangle{{Vec3(-9, -9, -4), Vec3(9, -9, -4), Vec3(0, 9, -4)}}, {}});
    instances.push_back({Box{Vec3(-6, -5, -6), Vec3(6, -4.5f, 6)}, {}});
    instances.push_back({Sphere{Vec3(0), 7}, {flattened, Vec3(0, 4, 0)}});
    const auto built = build(instances, {});
    ASSERT_EQ(dynamic_cast<const KdAccelerator&>(*built).large_objects(), 5u);
    std::vector<Ray> rays = make_rays(instances, 3000, 10);
    for (const Ray& ray : bundles(make_rays(instances, 60, 11), 12)) rays.push_back(ray);
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        expect_same_as_list(instances, rays, {1, 16, 1000});
    }
    use_instruction_set(instruction_sets().front());
}

/// Everything on the lattice: rays run within faces, along edges and through vertices.
/// The kernels test such triangles in pairs.
TEST(KdVersusList, TrianglesOfTheirOwnThatShareEdges) {
    for (const int rings : {4, 12}) {
        for (const float scale : {1.0f, 0x1p100f, 0x1p-120f}) {
            const MeshPtr ball = make_ball(rings, scale, scale * Vec3(0.1f, 0, 0), 0.2f, 31);
            std::vector<GeometryInstance> instances;
            for (const glm::uvec3& t : ball->triangles)
                instances.push_back({Triangle{{ball->positions[t.x], ball->positions[t.y], ball->positions[t.z]}}, {}});
            std::vector<Ray> rays = make_rays(instances, 2000, 32);
            for (const Ray& ray : bundles(make_rays(instances, 60, 33), 34)) rays.push_back(ray);
            const Vec3 eye = scale * Vec3(3, 2, 1);
            for (const Vec3& corner : ball->positions) rays.push_back({eye, 0, corner - eye, 2});
            for (const std::string_view set : instruction_sets()) {
                use_instruction_set(set);
                expect_same_as_list(instances, rays, {1, 16});
            }
            use_instruction_set(instruction_sets().front());
        }
    }
}

TEST(KdVersusList, LatticeRaysThroughLatticeGeometry) {
    std::vector<GeometryInstance> instances{{make_grid(16, 0), {}}, {make_grid(8, 0), {Mat3(1), Vec3(0, 0.5f, 0)}}};
    for (int i = -2; i < 2; ++i) {
        const auto x = static_cast<float>(i);
        instances.push_back({Box{Vec3(x, -1, -1), Vec3(x + 1, 0, 0)}, {}});
        instances.push_back({Quad{Vec3(x, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {}});
        instances.push_back({Triangle{{Vec3(x, 0, 0), Vec3(x, 1, 0), Vec3(x, 0, 1)}}, {}});
    }
    Random random(7);
    const auto lattice = [&] {
        return Vec3(random.integer(-16, 16), random.integer(-16, 16), random.integer(-16, 16)) / 8.0f;
    };
    std::vector<Ray> rays;
    while (rays.size() < 6000) {
        Ray ray{.origin = lattice()};
        ray.direction = lattice() - ray.origin;
        if (random.integer(0, 1)) ray.direction[random.integer(0, 2)] = 0;
        if (random.integer(0, 1)) ray.direction[random.integer(0, 2)] = 0;
        if (ray.direction != Vec3(0)) rays.push_back(ray);
    }
    expect_same_as_list(instances, rays, {1, 2, 16});
}

/// The ends of the interval count: with t_max the t of the hit it is still there, one ulp below it is not.
TEST(KdVersusList, IntervalEndsAreInclusive) {
    const auto instances = make_scene(11, 20, 100);
    std::vector<Ray> rays = make_rays(instances, 3000, 12);
    const auto list = scalar_list(instances);
    const Answers first = trace(*list, rays);
    std::vector<Ray> limited;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!first.hits[i].valid()) continue;
        const float t = first.hits[i].t;
        Ray ray = rays[i];
        for (const float end : {t, std::nextafter(t, -kInfinity), std::nextafter(t, kInfinity)}) {
            ray = rays[i];
            ray.t_max = end;
            limited.push_back(ray);
            ray = rays[i];
            ray.t_min = end;
            limited.push_back(ray);
        }
        EXPECT_TRUE(identical(intersect(*list, limited[limited.size() - 6]), first.hits[i]));
        EXPECT_FALSE(intersect(*list, limited[limited.size() - 4]).valid());
    }
    ASSERT_GT(limited.size(), 3000u);
    expect_same_as_list(instances, limited, {1, 8});
}

TEST(KdVersusList, FarFromTheOriginAndAtEveryScale) {
    for (const Vec3 offset : {Vec3(148376, 1234, -223423), Vec3(1e6f), Vec3(0)}) {
        for (const float scale : {1e-6f, 1.0f, 1e4f}) {
            Random random(5);
            auto instances = make_scene(21, 16, 80);
            for (GeometryInstance& instance : instances) {
                instance.to_world = Affine{Mat3(scale), offset} * instance.to_world;
            }
            std::vector<Ray> rays = make_rays(make_scene(21, 16, 80), 1000, 22);
            for (Ray& ray : rays) {
                ray.origin = scale * ray.origin + offset;
                ray.direction *= scale;
            }
            expect_same_as_list(instances, rays, {1, 16});
        }
    }
}

TEST(KdVersusList, RaysThatStayTogether) {
    for (std::uint64_t seed = 60; seed < 70; ++seed) {
        const auto instances = make_scene(seed, static_cast<int>(1 + 5 * (seed % 8)), 120);
        expect_same_as_list(instances, bundles(make_rays(instances, 120, seed), seed), {1, 6, 16, 200});
    }
}

/// SSE2 to AVX-512, whatever this machine has.
TEST(KdVersusList, EachInstructionSetGivesTheSame) {
    const auto instances = make_scene(41, 20, 300);
    std::vector<Ray> rays = make_rays(instances, 2000, 42);
    for (const Ray& ray : bundles(make_rays(instances, 100, 43), 44)) rays.push_back(ray);
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        expect_same_as_list(instances, rays, {1, 5, 16, 100});
    }
    use_instruction_set(instruction_sets().front());
}

TEST(KdVersusList, StrangeRaysMissOrAgree) {
    const auto instances = make_scene(31, 12, 50);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> values{nan,    kInfinity, -kInfinity, 0.0f,  -0.0f, 1e-45f, -1e-40f,
                                    1e-38f, 3e-30f,    1.0f,       -2.5f, 1e30f, -3e38f, 0.1f};
    Random random(3);
    const auto any = [&] {
        return values[static_cast<std::size_t>(random.integer(0, static_cast<int>(values.size()) - 1))];
    };
    std::vector<Ray> rays;
    for (int i = 0; i < 20000; ++i) {
        Ray ray = make_ray(instances, random);
        for (int change = random.integer(1, 4); change > 0; --change) {
            const int k = random.integer(0, 7);
            if (k < 3) ray.origin[k] = any();
            if (k >= 3 && k < 6) ray.direction[k - 3] = any();
            if (k == 6) ray.t_min = any();
            if (k == 7) ray.t_max = any();
        }
        rays.push_back(ray);
    }
    for (const float factor : {1e-40f, 1e-30f, 1e-20f, 1e20f, 1e30f}) {
        for (int i = 0; i < 500; ++i) {
            Ray ray{.origin = random.in_cube(5), .direction = random.direction() * factor};
            rays.push_back(ray);
        }
    }
    const auto list = scalar_list(instances);
    const Answers expected = trace(*list, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& r = rays[i];
        if (!is_finite(r.origin) || !is_finite(r.direction) || r.direction == Vec3(0) || !(r.t_min <= r.t_max)) {
            EXPECT_FALSE(expected.hits[i].valid());
        }
    }
    expect_same_as_list(instances, rays, {1, 16});
}

}  // namespace
}  // namespace rayuela::test
