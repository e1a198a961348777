#include "ui/gizmo.h"

#include "core/scene/scene_edit.h"
#include "ui/navigation.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

Affine moved(const Vec3& by) {
    return {Mat3(1), by};
}

Affine turned(float degrees, const Vec3& axis) {
    return {glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::normalize(axis))), Vec3(0)};
}

Affine scaled(const Vec3& by) {
    return {Mat3(by.x, 0, 0, 0, by.y, 0, 0, 0, by.z), Vec3(0)};
}

/// Every point of the object's space goes where `world` says.
void expect_at(const Scene& scene, const Object& object, const Affine& world) {
    Scene after = scene;
    after.objects[object.id.value - 1] = object;
    const Affine got = after.to_world(object.id);
    for (const Vec3& p : {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(2, -3, 4)}) {
        EXPECT_LE(glm::distance(got.point(p), world.point(p)), 1e-4f * (1 + glm::length(world.point(p))));
    }
}

/// A group that is moved, turned and scaled evenly, and a box in it, placed with everything but shear.
Scene grouped() {
    Scene scene;
    Object group{.id = {1}, .parent = {}, .name = "Group", .shape = ObjectList{}, .transform = {}, .material = {}};
    group.transform = {Vec3(3, 1, -2), glm::angleAxis(0.6f, glm::normalize(Vec3(1, 2, 3))), Vec3(2), {}};
    Object box{
        .id = {2}, .parent = {1}, .name = "Box", .shape = Box{Vec3(1), Vec3(2)}, .transform = {}, .material = {}};
    box.transform = {Vec3(-1, 0, 1), glm::angleAxis(-1.1f, glm::normalize(Vec3(0, 1, 1))), Vec3(1, 2, 0.5f), {}};
    scene.objects = {group, box};
    scene.next_id = 3;
    return scene;
}

TEST(Gizmo, MoveTurnAndScaleArriveInTheWorldThroughAGroup) {
    const Scene scene = grouped();
    const Object& box = scene.objects[1];
    const Affine before = scene.to_world(box.id);
    const Affine move = moved({0.5f, -2, 3}) * before;
    expect_at(scene, placed(scene, box, move, GizmoMode::translate), move);
    const Affine turn = turned(40, {1, 1, 0}) * before;
    expect_at(scene, placed(scene, box, turn, GizmoMode::rotate), turn);
    const Affine scale = before * scaled({1.5f, 0.5f, 3});
    expect_at(scene, placed(scene, box, scale, GizmoMode::scale), scale);
}

TEST(Gizmo, OnlyWhatIsDraggedChanges) {
    const Scene scene = grouped();
    const Object& box = scene.objects[1];
    const Affine before = scene.to_world(box.id);
    const Transform move = placed(scene, box, moved(Vec3(1)) * before, GizmoMode::translate).transform;
    EXPECT_EQ(move.rotate, box.transform.rotate);
    EXPECT_EQ(move.scale, box.transform.scale);
    const Transform turn = placed(scene, box, turned(10, Vec3(0, 1, 0)) * before, GizmoMode::rotate).transform;
    EXPECT_EQ(turn.scale, box.transform.scale);
    const Transform scale = placed(scene, box, before * scaled(Vec3(2)), GizmoMode::scale).transform;
    EXPECT_EQ(scale.rotate, box.transform.rotate);
}

TEST(Gizmo, MirroredObjectsStayMirrored) {
    Scene scene = grouped();
    scene.objects[1].transform.scale = {-1, 2, 0.5f};
    const Object& box = scene.objects[1];
    const Affine before = scene.to_world(box.id);
    const Affine scale = before * scaled(Vec3(1.5f));
    expect_at(scene, placed(scene, box, scale, GizmoMode::scale), scale);
    const Affine turn = turned(25, {0, 0, 1}) * before;
    expect_at(scene, placed(scene, box, turn, GizmoMode::rotate), turn);
}

TEST(Gizmo, AMatrixStaysAMatrix) {
    Scene scene = grouped();
    Mat4 shear(1);
    shear[1][0] = 0.5f;
    scene.objects[1].transform.matrix = shear;
    const Object& box = scene.objects[1];
    const Affine turn = turned(25, {0, 0, 1}) * scene.to_world(box.id);
    const Object result = placed(scene, box, turn, GizmoMode::rotate);
    EXPECT_TRUE(result.transform.matrix.has_value());
    expect_at(scene, result, turn);
}

TEST(Gizmo, PlanesMoveAndTurnOnly) {
    Scene scene;
    scene.objects = {{.id = {1},
                      .parent = {},
                      .name = "Plane",
                      .shape = Plane{Vec3(0, 2, 0), Vec3(0, 1, 0)},
                      .transform = {},
                      .material = {}}};
    scene.next_id = 2;
    const Object& plane = scene.objects[0];
    EXPECT_EQ(gizmo_pivot(scene, plane), Vec3(0, 2, 0));
    EXPECT_EQ(placed(scene, plane, scaled(Vec3(2)), GizmoMode::scale).transform.scale, Vec3(1));
    EXPECT_TRUE(apply(scene, SetObject{placed(scene, plane, turned(30, {1, 0, 0}), GizmoMode::rotate)}).has_value());
}

TEST(Gizmo, HandlesStandAtTheMiddleOfTheShape) {
    Scene scene = grouped();
    const Object& box = scene.objects[1];
    EXPECT_LE(glm::distance(gizmo_pivot(scene, box), Vec3(1.5f)), 1e-4f);
    scene.objects[1].shape = Sphere{Vec3(4, 5, 6), 2};
    EXPECT_LE(glm::distance(gizmo_pivot(scene, scene.objects[1]), Vec3(4, 5, 6)), 1e-4f);
}

TEST(Gizmo, MatricesProjectTheTargetToTheMiddle) {
    Camera camera;
    camera.position = {4, 3, 7};
    const Vec4 clip = projection_matrix(camera, 1.5f) * view_matrix(camera) * Vec4(camera.target, 1);
    EXPECT_NEAR(clip.x / clip.w, 0, 1e-5f);
    EXPECT_NEAR(clip.y / clip.w, 0, 1e-5f);
    EXPECT_LT(std::abs(clip.z / clip.w), 1);
    // A point at the upper edge of the image, by the field of view.
    const CameraFrame frame = camera_frame(camera);
    const float distance = glm::distance(camera.position, camera.target);
    const Vec3 edge = camera.target + frame.up * distance * std::tan(glm::radians(camera.vfov) / 2);
    const Vec4 top = projection_matrix(camera, 1.5f) * view_matrix(camera) * Vec4(edge, 1);
    EXPECT_NEAR(top.y / top.w, 1, 1e-4f);
}

}  // namespace
}  // namespace rayuela
