#include "core/render/path_health.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

const std::atomic<bool> kGoOn{false};

TEST(PathHealth, OfEveryShapeAndMaterialIsGood) {
    const auto scene = testing::make_render_scene(testing::mixed_scene(48, 32));
    const PathHealth health = measure_path_health(*scene, 3000, kGoOn);
    EXPECT_EQ(health.paths, 3000u);
    EXPECT_GT(health.scattered_rays, 3000u);
    EXPECT_GT(health.inner_rays, 100u) << "there is a glass ball";
    EXPECT_EQ(health.self_hits, 0u);
    EXPECT_EQ(health.left_closed, 0u);
    // Clay, gold, mirror and plastic from outside, glass from both sides; lamps scatter nothing.
    EXPECT_EQ(health.energy_tests, 5u * (4 + 2));
    EXPECT_EQ(health.draws, 4096u * health.energy_tests);
    EXPECT_EQ(health.above_one, 0u);
    EXPECT_NEAR(health.highest_share, 1, 0.02) << "mirror and glass keep all light";
}

TEST(PathHealth, MeasuresWhatAMirrorKeeps) {
    Scene scene = testing::empty_scene(4, 4);
    testing::add_material(scene, Metal{.albedo = {Color(0.9f), nullptr}});
    const PathHealth health = measure_path_health(*testing::make_render_scene(scene), 1, kGoOn);
    EXPECT_EQ(health.above_one, 0u);
    EXPECT_NEAR(health.highest_share, 0.9f, 1e-6f);
    EXPECT_EQ(health.without_pdf, 0u);
}

/// Weights of 0 and twice the share, with equal chance, but for the share of draws that fail.
PathHealth drawn(float share, float failing = 0) {
    PathHealth health;
    count_draws(
        [&](float u_lobe, const Vec2& u) -> std::optional<BsdfSample> {
            if (u.x < failing) return std::nullopt;
            return BsdfSample{
                .wi = Vec3(0, 0, 1), .weight = Color(u_lobe < 0.5f ? 0 : 2 * share, 0.5f, 0.5f), .pdf = 1};
        },
        health);
    return health;
}

TEST(PathHealth, KnowsMaterialsThatMakeLight) {
    // A standard error is 1/64: 1.12 is beyond four of them, 1 is not.
    EXPECT_EQ(drawn(1).above_one, 0u);
    EXPECT_EQ(drawn(1.12f).above_one, 1u);
    EXPECT_NEAR(drawn(1.12f).highest_share, 1.12f, 4 / 64.0f);
    EXPECT_EQ(drawn(std::numeric_limits<float>::quiet_NaN()).above_one, 1u) << "nothing that cannot be told is sound";
}

TEST(PathHealth, CountsDrawsWithoutADensity) {
    const PathHealth health = drawn(0.5f, 0.25f);
    EXPECT_EQ(health.draws, 4096u);
    EXPECT_NEAR(static_cast<double>(health.without_pdf), 1024, 5 * std::sqrt(4096 * 0.25 * 0.75));
    EXPECT_EQ(drawn(0.5f, 1).draws, 0u) << "black is no defect";
}

/// A made-up ray from one place to another.
PathHealth counted(const TracedShape& shape, const Vec3& normal, const Vec3& direction, float t, std::uint32_t object,
                   std::uint32_t primitive = 0) {
    const std::vector<GeometryInstance> instances{{shape, {}}, {Plane{}, {}}};
    PathRecord::Vertex from, to;
    from.hit = {.t = 1, .object = 0, .primitive = 0};
    from.point.p = normal;
    from.point.ng = normal;
    to.bounce = 1;
    to.ray = {.origin = 0.5f * normal, .direction = direction};
    to.hit = {.t = t, .object = object, .primitive = primitive};
    PathHealth health;
    count_ray(instances, from, to, health);
    EXPECT_EQ(health.scattered_rays, 1u);
    return health;
}

TEST(PathHealth, KnowsSelfHits) {
    const Vec3 up(0, 1, 0);
    EXPECT_EQ(counted(Plane{}, up, up, 0.1f, 0).self_hits, 1u);
    EXPECT_EQ(counted(Plane{}, up, up, 0.1f, 1).self_hits, 0u);
    EXPECT_EQ(counted(Sphere{Vec3(0), 1}, up, up, 0.1f, 0).self_hits, 1u) << "left to the outside";
    EXPECT_EQ(counted(Sphere{Vec3(0), 1}, up, -up, 2, 0).self_hits, 0u) << "through the ball";
    EXPECT_EQ(counted(Box{Vec3(-1), Vec3(1)}, up, -up, 2, 0, 2).self_hits, 0u) << "the face across";
}

TEST(PathHealth, KnowsRaysThatLeaveAClosedObject) {
    const Vec3 up(0, 1, 0);
    for (const TracedShape& shape : {TracedShape(Sphere{Vec3(0), 1}), TracedShape(Box{Vec3(-1), Vec3(1)})}) {
        const auto inner = [&](float t, std::uint32_t object, std::uint32_t primitive) {
            const PathHealth health = counted(shape, up, -up, t, object, primitive);
            EXPECT_EQ(health.inner_rays, 1u);
            return health.left_closed;
        };
        EXPECT_EQ(inner(1.5f, 0, 2), 0u) << "the surface across";
        EXPECT_EQ(inner(1, 1, 0), 0u) << "something inside";
        EXPECT_EQ(inner(1.75f, 1, 0), 1u) << "something beyond";
        EXPECT_EQ(inner(kInfinity, kNone, kNone), 1u);
        EXPECT_EQ(counted(shape, up, up, kInfinity, kNone).inner_rays, 0u);
    }
    EXPECT_EQ(counted(Plane{}, up, -up, kInfinity, kNone).inner_rays, 0u) << "a plane encloses nothing";
}

}  // namespace
}  // namespace rayuela
