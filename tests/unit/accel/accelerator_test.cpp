#include "core/accel/accelerator.h"

#include "core/accel/kd_accelerator.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rayuela::test {
namespace {

constexpr AccelSettings kList{.kind = AcceleratorKind::list};
constexpr AccelSettings kKd{.kind = AcceleratorKind::kd};

class EachStructure : public ::testing::TestWithParam<AccelSettings> {};

TEST_P(EachStructure, EmptySceneHasNoHitsAndNoBounds) {
    const auto accelerator = build({}, GetParam());
    EXPECT_FALSE(intersect(*accelerator, {}).valid());
    EXPECT_TRUE(accelerator->bounds().empty());
    EXPECT_EQ(accelerator->stats().primitives, 0u);
    std::vector<std::uint8_t> blocked{7, 7};
    accelerator->occluded(std::vector<Ray>(2), blocked);
    EXPECT_EQ(blocked, (std::vector<std::uint8_t>{0, 0}));
}

TEST_P(EachStructure, PlanesAloneAreHitAndHaveNoBounds) {
    const auto accelerator = build({{Plane{}, {}}, {Plane{Vec3(0, -1, 0)}, {}}}, GetParam());
    EXPECT_TRUE(accelerator->bounds().empty());
    const Hit hit = intersect(*accelerator, {.origin = Vec3(0, 2, 0), .direction = Vec3(0, -1, 0)});
    EXPECT_EQ(hit.object, 0u);
    EXPECT_EQ(hit.t, 2.0f);
}

TEST_P(EachStructure, OneObjectOfEachKind) {
    const Ray down{.origin = Vec3(0.1f, 4, 0.2f), .direction = Vec3(0, -2, 0)};
    const Triangle triangle{{Vec3(-1, 1, 2), Vec3(2, 1, 2), Vec3(0, 1, -2)}};
    const MeshPtr mesh = make_mesh({triangle.vertices.begin(), triangle.vertices.end()}, {{0, 1, 2}});
    const std::vector<TracedShape> at_height_one{Plane{Vec3(0, 1, 0)}, Box{Vec3(-1), Vec3(1)}, triangle,
                                                 Quad{Vec3(-1, 1, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)}, mesh};
    for (const TracedShape& shape : at_height_one) {
        const auto accelerator = build({{shape, {}}}, GetParam());
        const Hit hit = intersect(*accelerator, down);
        EXPECT_EQ(hit.t, 1.5f) << "shape " << shape.index();
        EXPECT_EQ(hit.object, 0u);
        // Lifted by one; scaled about the origin.
        EXPECT_EQ(intersect(*build({{shape, {Mat3(1), Vec3(0, 1, 0)}}}, GetParam()), down).t, 1.0f);
        EXPECT_EQ(intersect(*build({{shape, {Mat3(2), Vec3(0)}}}, GetParam()), down).t, 1.0f);
    }
    EXPECT_EQ(intersect(*build({{Sphere{Vec3(0.1f, 0, 0.2f), 1}, {}}}, GetParam()), down).t, 1.5f);
}

TEST_P(EachStructure, EqualDistancesGoToTheLowestNumber) {
    const Quad quad{Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)};
    const std::vector<GeometryInstance> instances(40, GeometryInstance{quad, {}});
    const Hit hit =
        intersect(*build(instances, GetParam()), {.origin = Vec3(0.3f, 1, 0.2f), .direction = Vec3(0, -1, 0)});
    EXPECT_EQ(hit.object, 0u);
}

TEST_P(EachStructure, CancelledBuildGivesNothing) {
    BuildControl control;
    control.cancelled = true;
    EXPECT_EQ(Accelerator::build(make_scene(1, 5, 50), GetParam(), nullptr, control), nullptr);
}

INSTANTIATE_TEST_SUITE_P(All, EachStructure,
                         ::testing::Values(kList, kKd, AccelSettings{.leaf_size = 1, .split = KdSplit::median}));

/// They go through the tree together at first; the lamp is so large, and the way so long, that they part at different nodes.
TEST(KdAccelerator, NeighboursToALampFindWhatTheListFinds) {
    const std::vector<GeometryInstance> land{{make_grid(60, 0.3f), {}}};
    const auto list = build(land, kList), kd = build(land, kKd);
    const Bounds3 bounds = kd->bounds();
    const Vec3 size = bounds.hi - bounds.lo;
    Random random(5);
    for (const float lamp : {0.0f, 0.1f, 1.0f, 2.0f}) {
        std::vector<Ray> rays;
        for (int i = 0; i < 256; ++i) {
            const Vec3 middle = bounds.lo + (Vec3(0.5f) + random.in_cube(0.5f)) * size;
            for (int k = 0; k < 16; ++k) {
                const Vec3 origin = middle + random.in_cube(0.01f) * size;
                rays.push_back({.origin = origin,
                                .direction = bounds.hi + size + lamp * random.in_cube(1) - origin,
                                .t_max = 0.9999f});
            }
        }
        std::vector<std::uint8_t> expected(rays.size()), blocked(rays.size());
        list->occluded(rays, expected);
        kd->occluded(rays, blocked);
        EXPECT_EQ(blocked, expected) << "lamp " << lamp;
        EXPECT_GT(std::ranges::count(blocked, 1), 0);
        EXPECT_GT(std::ranges::count(blocked, 0), 0);
    }
}

TEST(KdAccelerator, MeshTreesAreSharedAndReused) {
    const MeshPtr ball = make_ball(8, 1, Vec3(0), 0, 1), grid = make_grid(4, 0);
    const std::vector<GeometryInstance> instances{{ball, {}}, {ball, {Mat3(2), Vec3(3)}}, {grid, {}}, {Sphere{}, {}}};
    BuildControl control;
    const auto first = Accelerator::build(instances, kKd, nullptr, control);
    const auto tree = [](const auto& accelerator, std::uint32_t object) {
        return dynamic_cast<const KdAccelerator&>(*accelerator).mesh_tree(object);
    };
    EXPECT_EQ(tree(first, 0), tree(first, 1));
    EXPECT_NE(tree(first, 0), tree(first, 2));
    EXPECT_EQ(tree(first, 3), nullptr);

    auto moved = instances;
    moved[1].to_world.translation = Vec3(-5);
    const auto second = Accelerator::build(moved, kKd, first.get(), control);
    EXPECT_EQ(tree(second, 0), tree(first, 0));
    EXPECT_EQ(tree(second, 2), tree(first, 2));
    const auto other = Accelerator::build(moved, {.leaf_size = 4}, second.get(), control);
    EXPECT_NE(tree(other, 0), tree(first, 0));
    const auto from_list = Accelerator::build(moved, kKd, build(moved, kList).get(), control);
    EXPECT_NE(tree(from_list, 0), nullptr);
}

TEST(KdAccelerator, StatsCountEachMeshOnce) {
    const MeshPtr grid = make_grid(10, 0.1f);  // 200 triangles
    const std::vector<GeometryInstance> instances{
        {grid, {}}, {grid, {Mat3(1), Vec3(5, 0, 0)}}, {Sphere{}, {}}, {Plane{}, {}}};
    const AccelStats stats = build(instances, kKd)->stats();
    EXPECT_EQ(stats.primitives, 202u);
    EXPECT_GE(stats.references, 200u + 3u);
    EXPECT_EQ(stats.nodes, 2 * stats.leaves - 2) << "two binary trees";
    EXPECT_GT(stats.memory_bytes, 121u * 12u + 200u * 8u) << "positions, corners and names once";
    EXPECT_GT(stats.build_seconds, 0);
    EXPECT_EQ(build(instances, kList)->stats().primitives, 202u);
}

TEST(KdAccelerator, BoundsHoldEveryObjectButPlanes) {
    const auto accelerator =
        build({{Sphere{Vec3(1, 2, 3), 2}, {}}, {Plane{}, {}}, {Box{}, {Mat3(2), Vec3(10, 0, 0)}}}, kKd);
    const Bounds3 bounds = accelerator->bounds();
    EXPECT_NEAR(bounds.lo.x, -1, 1e-6f);
    EXPECT_NEAR(bounds.hi.x, 11, 1e-5f);
    EXPECT_NEAR(bounds.hi.y, 4, 1e-6f);
    EXPECT_NEAR(bounds.hi.z, 5, 1e-6f);
}

}  // namespace
}  // namespace rayuela::test
