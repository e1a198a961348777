#include "ui/navigation.h"

#include <gmock/gmock.h>

#include <random>

namespace rayuela {
namespace {

using testing::FloatNear;

constexpr float kTolerance = 1e-4f;

MATCHER_P(Near, expected, "") {
    return glm::distance(arg, expected) <= kTolerance * (1 + glm::length(expected));
}

/// Cameras of all directions and scales.
std::vector<Camera> cameras() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<Camera> found{Camera{}};
    for (const float scale : {1e-3f, 1.0f, 1e4f}) {
        for (int i = 0; i < 30; ++i) {
            Camera camera;
            camera.target = scale * Vec3(uniform(random), uniform(random), uniform(random));
            camera.position =
                camera.target + scale * Vec3(uniform(random), 0.5f * uniform(random), 1 + uniform(random));
            camera.vfov = 50 + 40 * uniform(random);
            found.push_back(camera);
        }
    }
    return found;
}

/// Position in the image, its height being 1, of a world point, by similar triangles.
Vec2 projected(const Camera& camera, const Vec3& point) {
    const Vec3 forward = glm::normalize(camera.target - camera.position);
    const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
    const Vec3 up = glm::cross(right, forward);
    const Vec3 v = point - camera.position;
    const float depth = glm::dot(v, forward) * 2 * std::tan(glm::radians(camera.vfov) / 2);
    return {0.5f + glm::dot(v, right) / depth, 0.5f - glm::dot(v, up) / depth};
}

TEST(Navigation, OrbitKeepsDistanceTargetAndUp) {
    for (const Camera& camera : cameras()) {
        const Camera turned = orbit(camera, 0.4f, -0.3f);
        EXPECT_EQ(turned.target, camera.target);
        EXPECT_EQ(turned.up, camera.up);
        const float distance = glm::distance(camera.position, camera.target);
        EXPECT_THAT(glm::distance(turned.position, turned.target), FloatNear(distance, 1e-5f * distance));
        EXPECT_NE(turned.position, camera.position);
    }
}

TEST(Navigation, OrbitByAQuarterGoesToTheRight) {
    Camera camera;
    camera.position = {0, 0, 5};
    camera.target = {0, 0, 0};
    EXPECT_THAT(orbit(camera, kPi / 2, 0).position, Near(Vec3(5, 0, 0)));
    EXPECT_THAT(orbit(camera, 0, kPi / 4).position, Near(Vec3(0, 5, 5) / std::sqrt(2.0f)));
}

TEST(Navigation, OrbitThereAndBackReturns) {
    for (const Camera& camera : cameras()) {
        const Camera back = orbit(orbit(camera, 0.7f, 0), -0.7f, 0);
        EXPECT_THAT(back.position, Near(camera.position));
    }
}

TEST(Navigation, OrbitStopsBeforeThePoles) {
    for (const Camera& camera : cameras()) {
        for (const float pitch : {10.0f, -10.0f}) {
            const Camera turned = orbit(camera, 0, pitch);
            const Vec3 view = glm::normalize(turned.target - turned.position);
            EXPECT_LT(std::abs(glm::dot(view, Vec3(0, 1, 0))), 0.99995f);
            // The image does not turn over: its right stays on the same side.
            EXPECT_GT(glm::dot(camera_frame(turned).right, camera_frame(camera).right), 0.9f);
        }
    }
}

TEST(Navigation, LookKeepsTheEye) {
    for (const Camera& camera : cameras()) {
        const Camera turned = look(camera, 0.2f, 0.1f);
        EXPECT_EQ(turned.position, camera.position);
        // What was in the middle goes to the left and down.
        const Vec2 seen = projected(turned, camera.target);
        EXPECT_LT(seen.x, 0.5f);
        EXPECT_GT(seen.y, 0.5f);
    }
}

TEST(Navigation, PanMovesTheTargetsDepthWithTheMouse) {
    for (const Camera& camera : cameras()) {
        const Vec2 delta(0.25f, -0.1f);
        const Vec2 seen = projected(pan(camera, delta), camera.target);
        EXPECT_NEAR(seen.x, 0.5f + delta.x, 1e-3f);
        EXPECT_NEAR(seen.y, 0.5f + delta.y, 1e-3f);
    }
}

TEST(Navigation, DollyScalesTheDistanceAndNeverArrives) {
    for (const Camera& camera : cameras()) {
        const float distance = glm::distance(camera.position, camera.target);
        EXPECT_THAT(glm::distance(dolly(camera, 0.9f).position, camera.target),
                    FloatNear(0.9f * distance, 1e-4f * distance));
        Camera near = camera;
        for (int i = 0; i < 2000; ++i) {
            near = dolly(near, 0.9f);
        }
        EXPECT_NE(near.position, near.target);
        EXPECT_TRUE(is_finite(near.position));
    }
}

TEST(Navigation, FlyMovesEyeAndTargetTogether) {
    Camera camera;
    camera.position = {0, 1, 5};
    camera.target = {0, 1, 0};
    const Camera moved = fly(camera, {1, 2, 3});
    EXPECT_THAT(moved.position, Near(Vec3(1, 3, 2)));
    EXPECT_THAT(moved.target - moved.position, Near(camera.target - camera.position));
}

TEST(Navigation, FlightSpeedScalesWithTheScene) {
    Camera camera;
    const Bounds3 scene{Vec3(-3), Vec3(3)};
    const float speed = fly_speed(camera, scene);
    EXPECT_GT(speed, 0);
    Camera large = camera;
    large.position *= 1024.0f;
    large.target *= 1024.0f;
    EXPECT_FLOAT_EQ(fly_speed(large, {Vec3(-3 * 1024.0f), Vec3(3 * 1024.0f)}), 1024 * speed);
    EXPECT_GT(fly_speed(camera, Bounds3{}), 0);
}

TEST(Navigation, DegenerateCamerasStayFinite) {
    Camera along_up;
    along_up.position = {0, 5, 0};
    along_up.target = {0, 0, 0};
    Camera at_target;
    at_target.position = at_target.target;
    Camera no_up;
    no_up.up = Vec3(0);
    for (const Camera& camera : {along_up, at_target, no_up}) {
        const CameraFrame frame = camera_frame(camera);
        EXPECT_NEAR(glm::length(frame.right), 1, 1e-5f);
        EXPECT_NEAR(glm::dot(frame.right, frame.forward), 0, 1e-5f);
        EXPECT_TRUE(is_finite(orbit(camera, 0.3f, 0.2f).position));
        EXPECT_TRUE(is_finite(pan(camera, {0.1f, 0.1f}).position));
        EXPECT_TRUE(is_finite(fly(camera, Vec3(1)).position));
    }
}

}  // namespace
}  // namespace rayuela
