#include "core/render/health_maps.h"
#include "core/math/float_error.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

using testing::add_material;
using testing::add_object;
using testing::empty_scene;
using testing::make_render_scene;

constexpr glm::ivec2 kSize(48, 32);
const std::atomic<bool> kGoOn{false}, kCancelled{true};

Scene view_of_nothing() {
    return empty_scene(kSize.x, kSize.y);
}

/// Straight down from a height onto the plane y = 0.
Scene floor_from_above(float height) {
    Scene scene = view_of_nothing();
    scene.camera.position = Vec3(0, height, 0);
    scene.camera.target = Vec3(0);
    scene.camera.up = Vec3(0, 0, -1);
    add_object(scene, Plane{});
    return scene;
}

TEST(PositionErrorMap, OfAPlaneLiesBetweenTheRoundingOfItsPointsAndGamma) {
    for (const float height : {1e-3f, 3.0f, 4e4f}) {
        const Scene scene = floor_from_above(height);
        const auto map = position_error_map(*make_render_scene(scene), kSize, kGoOn);
        ASSERT_EQ(map.size(), 48u * 32u);
        const double half = std::tan(glm::radians(double{scene.camera.vfov}) / 2) * double{height};
        for (int y = 0; y < kSize.y; ++y) {
            for (int x = 0; x < kSize.x; ++x) {
                const Vec3d p(half * (2 * (x + 0.5) - kSize.x) / kSize.y, 0, half * (2 * (y + 0.5) / kSize.y - 1));
                const double relative = glm::length(p) / glm::length(p - Vec3d(0, height, 0));
                const double value = double{map[static_cast<std::size_t>(y * kSize.x + x)]};
                EXPECT_GE(value, 0.9999 * double{kUnitRoundoff} * relative) << x << ' ' << y << " from " << height;
                EXPECT_LE(value, double{gamma(2)} * relative) << x << ' ' << y << " from " << height;
            }
        }
    }
}

TEST(PositionErrorMap, IsNotANumberWhereThereIsNothing) {
    Scene scene = view_of_nothing();
    scene.camera.position = Vec3(0, 1, 0);
    scene.camera.target = Vec3(0, 1, -1);
    add_object(scene, Plane{});
    const auto map = position_error_map(*make_render_scene(scene), kSize, kGoOn);
    for (std::size_t i = 0; i < map.size(); ++i) EXPECT_EQ(std::isnan(map[i]), i < map.size() / 2) << i;
}

TEST(PositionErrorMap, GrowsWithTheDistanceFromTheOrigin) {
    // An infinite plane keeps the scene where it is.
    Scene scene = floor_from_above(1);
    const auto near = position_error_map(*make_render_scene(scene), kSize, kGoOn);
    scene.camera.position.x = scene.camera.target.x = 4096;
    const auto far = position_error_map(*make_render_scene(scene), kSize, kGoOn);
    for (std::size_t i = 0; i < far.size(); ++i) EXPECT_GT(far[i], 1000 * near[i]);
}

TEST(RetraceMap, EveryShapeAgreesToTheRoundingOfFloat) {
    Scene scene = testing::mixed_scene(kSize.x, kSize.y);
    Transform turned;
    turned.translate = Vec3(-1, 1.6f, 1);
    turned.rotate = glm::angleAxis(0.7f, glm::normalize(Vec3(1, 2, 0.5f)));
    turned.scale = Vec3(0.5f, 1, 0.7f);
    add_object(scene, Box{Vec3(-0.5f), Vec3(0.5f)}, {}, turned);
    turned.translate = Vec3(2.2f, 1.8f, 0);
    add_object(scene, Sphere{Vec3(0), 0.5f}, {}, turned);
    add_object(scene, Mesh{"torus", testing::torus_mesh()}, {}, turned);
    const Vec3 views[] = {Vec3(0, 2.5f, 7), Vec3(0, 0.5f, 0.4f), Vec3(-1.8f, 0.8f, 0)};
    for (const AcceleratorKind kind : {AcceleratorKind::kd, AcceleratorKind::list}) {
        scene.render.accel.kind = kind;
        for (const Vec3& from : views) {
            scene.camera.position = from;
            const auto map = retrace_map(*make_render_scene(scene), kSize, kGoOn);
            ASSERT_EQ(map.size(), 48u * 32u);
            std::size_t met = 0;
            for (const float value : map) {
                if (std::isnan(value)) continue;
                ++met;
                EXPECT_LE(value, 1.01f * kUnitRoundoff);
            }
            EXPECT_GT(met, map.size() / 4);
        }
    }
}

TEST(RetraceMap, GroundOfLargeRadiusAndSceneFarAway) {
    Scene ground = view_of_nothing();
    ground.camera.position = Vec3(0, 2, 0);
    ground.camera.target = Vec3(0, 1, -3);
    add_object(ground, Sphere{Vec3(0, -1e6f, 0), 1e6f});
    Scene far = testing::mixed_scene(kSize.x, kSize.y);
    Transform away;
    away.translate = Vec3(1e6f, 0, 5e5f);
    for (Object& object : far.objects) object.transform.translate += away.translate;
    std::erase_if(far.objects, [](const Object& o) { return std::holds_alternative<Plane>(o.shape); });
    far.camera.position += away.translate;
    far.camera.target += away.translate;
    for (const Scene& scene : {ground, far}) {
        std::size_t met = 0;
        for (const float value : retrace_map(*make_render_scene(scene), kSize, kGoOn)) {
            if (std::isnan(value)) continue;
            ++met;
            EXPECT_LE(value, 1.01f * kUnitRoundoff);
        }
        EXPECT_GT(met, 200u);
    }
}

TEST(RetraceMap, SaysWhatDisagrees) {
    const Hit hit{.t = 2, .object = 1, .primitive = 3};
    EXPECT_EQ(disagreement(hit, {2.0, 1, 3}), 0);
    EXPECT_FLOAT_EQ(disagreement(hit, {2.5, 1, 3}), 0.2f);
    EXPECT_EQ(disagreement(hit, {2.5, 1, 4}), kInfinity) << "another triangle elsewhere";
    EXPECT_EQ(disagreement(hit, {1.0, 0, 3}), kInfinity) << "another object elsewhere";
    EXPECT_LT(disagreement(hit, {2.0 * (1 + 0x1p-25), 0, 0}), kUnitRoundoff) << "a tie";
    EXPECT_EQ(disagreement(hit, {}), kInfinity);
    EXPECT_EQ(disagreement({}, {2.0, 1, 3}), kInfinity);
    EXPECT_TRUE(std::isnan(disagreement({}, {})));
}

TEST(ReferenceTrace, KnowsClosedForms) {
    Camera camera;
    camera.position = Vec3(0, 0, 5);
    camera.target = Vec3(0);
    const CameraRays rays(camera, 1);
    const glm::ivec2 one(1, 1);
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = {{-9, -9, 1}, {9, -9, 1}, {0, 9, 1}, {-9, -9, 2}, {9, -9, 2}, {0, 9, 2}};
    mesh->triangles = {{0, 1, 2}, {5, 4, 3}};
    for (const Vec3& p : mesh->positions) mesh->bounds.extend(p);
    const auto first = [&](std::vector<GeometryInstance> instances) {
        return reference_trace(instances, rays, one, kGoOn).at(0);
    };
    const auto expect = [](const ReferenceHit& hit, double t, std::uint32_t object, std::uint32_t primitive) {
        EXPECT_DOUBLE_EQ(hit.t, t);
        EXPECT_EQ(hit.object, object);
        EXPECT_EQ(hit.primitive, primitive);
    };
    expect(first({{Sphere{Vec3(0), 1.5f}, {}}}), 3.5, 0, 0);
    expect(first({{Plane{Vec3(0), Vec3(0, 0, 1)}, {}}, {Box{Vec3(-1), Vec3(1)}, {}}}), 4, 1, 5);
    expect(first({{Plane{Vec3(0), Vec3(0, 0, 1)}, {}}}), 5, 0, 0);
    expect(first({{Quad{Vec3(-1, -1, 3), Vec3(2, 0, 0), Vec3(0, 2, 0)}, {}}}), 2, 0, 0);
    expect(first({{mesh, {}}}), 3, 0, 1);
    EXPECT_FALSE(first({{Sphere{Vec3(0, 0, 9), 1}, {}}}).valid()) << "behind the camera";
    expect(first({{Sphere{Vec3(0, 0, 5), 2}, {}}}), 2, 0, 0);
}

/// Light of no size that can be told, over the left half of the image.
TEST(RejectedMap, ShowsEachPixelThatSeesWhatIsNotANumber) {
    constexpr int kSamples = 3;
    Scene scene = view_of_nothing();
    scene.camera.position = Vec3(0, 0, 5);
    scene.camera.target = Vec3(0);
    scene.environment = ConstantEnvironment{Color(1)};
    scene.render.max_bounces = 0;
    const MaterialId broken =
        add_material(scene, Emitter{.radiance = {Color(std::numeric_limits<float>::quiet_NaN()), nullptr}});
    add_object(scene, Quad{Vec3(-50, -50, 0), Vec3(50, 0, 0), Vec3(0, 100, 0)}, broken);
    const auto accumulation = testing::render(scene, kSamples);
    const auto map = rejected_map(accumulation->rejected_pixels(), kSize);
    ASSERT_EQ(map.size(), 48u * 32u);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
        EXPECT_EQ(map[i], i % 48 < 24 ? kSamples : 0) << i;
        sum += static_cast<std::uint64_t>(map[i]);
    }
    EXPECT_EQ(accumulation->film().rejected()[static_cast<std::size_t>(Rejection::nan)], sum);
}

TEST(RejectedMap, IsEmptyOfAHealthyFilm) {
    EXPECT_TRUE(testing::render(testing::mixed_scene(24, 16), 2)->rejected_pixels().empty());
}

TEST(HealthMaps, CanBeCancelled) {
    const auto scene = make_render_scene(testing::mixed_scene(kSize.x, kSize.y));
    EXPECT_TRUE(position_error_map(*scene, kSize, kCancelled).empty());
    EXPECT_TRUE(retrace_map(*scene, kSize, kCancelled).empty());
}

}  // namespace
}  // namespace rayuela
