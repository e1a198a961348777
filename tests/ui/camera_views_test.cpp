#include "ui/camera_views.h"

#include <gmock/gmock.h>

#include <random>

namespace rayuela {
namespace {

TEST(CameraViews, LookAlongTheirAxisFromTheSameDistance) {
    Camera camera;
    camera.position = {3, 4, 12};
    camera.target = {1, 2, 3};
    const float distance = glm::distance(camera.position, camera.target);
    for (const AxisView& view : axis_views()) {
        const Camera turned = looking_along(camera, view);
        EXPECT_EQ(turned.target, camera.target);
        EXPECT_LT(glm::distance(glm::normalize(turned.target - turned.position), view.direction), 1e-6f) << view.name;
        EXPECT_NEAR(glm::distance(turned.position, turned.target), distance, 1e-5f);
        EXPECT_LT(std::abs(glm::dot(turned.up, view.direction)), 1e-6f);
    }
}

/// Every corner of the bounds lies within the image, and the image is not much larger than needed.
TEST(CameraViews, FramingHasTheBoundsInView) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (const float aspect : {0.5f, 1.0f, 2.0f}) {
        for (const float scale : {1e-4f, 1.0f, 1e5f}) {
            Camera camera;
            camera.position = Vec3(uniform(random), uniform(random), 2);
            camera.vfov = 45;
            Bounds3 bounds;
            bounds.extend(scale * Vec3(uniform(random), uniform(random), uniform(random)));
            bounds.extend(scale * Vec3(2 + uniform(random), 1 + uniform(random), 2));
            const Camera framed = framing(camera, bounds, aspect);

            const Vec3 forward = glm::normalize(framed.target - framed.position);
            const Vec3 right = glm::normalize(glm::cross(forward, framed.up)), up = glm::cross(right, forward);
            EXPECT_LT(glm::distance(forward, glm::normalize(camera.target - camera.position)), 1e-4f);
            float largest = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const Vec3 p((corner & 1 ? bounds.hi : bounds.lo).x, (corner & 2 ? bounds.hi : bounds.lo).y,
                             (corner & 4 ? bounds.hi : bounds.lo).z);
                const Vec3 d = p - framed.position;
                const float depth = glm::dot(d, forward) * std::tan(glm::radians(camera.vfov) / 2);
                ASSERT_GT(depth, 0);
                largest = std::max(
                    {largest, std::abs(glm::dot(d, up)) / depth, std::abs(glm::dot(d, right)) / (depth * aspect)});
            }
            EXPECT_LE(largest, 1);
            EXPECT_GE(largest, 0.3f);
            EXPECT_NEAR(framed.focus_distance, glm::distance(framed.position, bounds.center()),
                        1e-3f * framed.focus_distance);
        }
    }
}

TEST(CameraViews, NothingToFrameChangesNothing) {
    EXPECT_EQ(framing(Camera{}, Bounds3{}, 1), Camera{});
}

TEST(CameraViews, FocusIsMeasuredAlongTheViewAxis) {
    Camera camera;
    camera.position = {0, 0, 0};
    camera.target = {0, 0, -1};
    EXPECT_FLOAT_EQ(focused_on(camera, {3, 4, -7}).focus_distance, 7);
    EXPECT_EQ(focused_on(camera, {0, 0, 2}), camera) << "behind the eye";
}

TEST(CameraViews, APlaneIsFramedAroundItsPoint) {
    Scene scene;
    Object plane;
    plane.id = ObjectId{1};
    plane.shape = Plane{{2, 0, 0}, {0, 1, 0}};
    scene.objects.push_back(plane);
    const Bounds3 bounds = bounds_to_frame(scene, ObjectId{1});
    EXPECT_FALSE(bounds.empty());
    EXPECT_EQ(bounds.center(), Vec3(2, 0, 0));
    EXPECT_TRUE(bounds_to_frame(scene, {}).empty());
}

}  // namespace
}  // namespace rayuela
