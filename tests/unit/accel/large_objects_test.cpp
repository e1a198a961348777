#include "core/accel/large_objects.h"

#include "tests/support/accel_scenes.h"

#include <gmock/gmock.h>

namespace rayuela::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::uint32_t> large_in(const std::vector<GeometryInstance>& instances) {
    std::vector<TracedObject> objects;
    std::vector<Bounds3> bounds;
    for (const GeometryInstance& instance : instances) {
        objects.emplace_back(instance);
        const TriangleMesh* mesh = objects.back().mesh();
        bounds.push_back(world_bounds(objects.back(), instance, mesh ? mesh->bounds : Bounds3()));
    }
    return find_large_objects(objects, bounds);
}

/// 10 x 10 balls of radius 0.3 on the ground; their bounds have a surface of 2 (9.6 * 9.6 + 2 * 9.6 * 0.6) = 207.4.
std::vector<GeometryInstance> crowd() {
    std::vector<GeometryInstance> instances;
    for (int i = 0; i < 100; ++i)
        instances.push_back({Sphere{Vec3(static_cast<float>(i % 10), 0.3f, static_cast<float>(i / 10)), 0.3f}, {}});
    return instances;
}

GeometryInstance floor_of(float side) {
    return {Quad{Vec3(0), Vec3(side, 0, 0), Vec3(0, 0, side)}, {}};
}

TEST(LargeObjects, TheGroundOfACrowd) {
    EXPECT_THAT(large_in(crowd()), IsEmpty());
    auto instances = crowd();
    instances.push_back({Sphere{Vec3(0, -1000, 0), 1000}, {}});
    EXPECT_THAT(large_in(instances), ElementsAre(100u));
}

TEST(LargeObjects, HaveAnEighthOfTheSurfaceOfAllThatIsSmaller) {
    auto instances = crowd();
    // 2 s^2 = 207.4 / 8 has s = 3.6.
    instances.push_back(floor_of(3.5f));
    EXPECT_THAT(large_in(instances), IsEmpty());
    instances.back() = floor_of(3.7f);
    EXPECT_THAT(large_in(instances), ElementsAre(100u));
}

TEST(LargeObjects, LargestFirstAndNoMoreThanTheLimit) {
    auto instances = crowd();
    for (int i = 0; i < 20; ++i) instances.push_back(floor_of(20 + static_cast<float>(i)));
    const std::vector<std::uint32_t> large = large_in(instances);
    ASSERT_EQ(large.size(), kLargePrimitives);
    for (std::uint32_t k = 0; k < large.size(); ++k) EXPECT_EQ(large[k], 119 - k);
}

TEST(LargeObjects, NoPlaneNoMeshAndNothingWithoutEnd) {
    auto instances = crowd();
    instances.push_back({Plane{}, {}});
    instances.push_back({make_ball(6, 50, Vec3(0), 0, 1), {}});
    instances.push_back({Sphere{Vec3(0), kInfinity}, {}});
    EXPECT_THAT(large_in(instances), IsEmpty());
}

}  // namespace
}  // namespace rayuela::test
