#include "ui/transform_edit.h"

#include <gmock/gmock.h>

#include <random>

namespace rayuela {
namespace {

float distance(const Affine& a, const Affine& b) {
    float largest = glm::length(a.translation - b.translation);
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, glm::length(a.linear[axis] - b.linear[axis]));
    return largest;
}

TEST(TransformEdit, DegreesGiveTheRotationTheyCameFrom) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> angle(-180, 180);
    for (int i = 0; i < 1000; ++i) {
        Vec3 degrees(angle(random), angle(random), angle(random));
        if (i % 3 == 0) degrees.y = i % 2 == 0 ? 90.0f : -90.0f;
        const Quat rotation = rotation_from_degrees(degrees);
        const Quat again = rotation_from_degrees(degrees_from_rotation(rotation));
        EXPECT_GT(std::abs(glm::dot(rotation, again)), 1 - 1e-5f) << degrees.x << ' ' << degrees.y << ' ' << degrees.z;
    }
}

TEST(TransformEdit, AQuarterAboutZTurnsXIntoY) {
    const Vec3 turned = rotation_from_degrees({0, 0, 90}) * Vec3(1, 0, 0);
    EXPECT_LT(glm::distance(turned, Vec3(0, 1, 0)), 1e-6f);
    // x first, z last: y goes to z by the first and stays there.
    const Vec3 twice = rotation_from_degrees({90, 0, 90}) * Vec3(0, 1, 0);
    EXPECT_LT(glm::distance(twice, Vec3(0, 0, 1)), 1e-6f);
}

TEST(TransformEdit, DecompositionRebuildsTheAffine) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(-3, 3);
    for (int i = 0; i < 200; ++i) {
        Transform transform;
        transform.translate = {uniform(random), uniform(random), uniform(random)};
        transform.rotate = glm::normalize(Quat(uniform(random), uniform(random), uniform(random), uniform(random)));
        transform.scale = {0.1f + std::abs(uniform(random)), uniform(random) > 0 ? 2.0f : -2.0f, 0.5f};
        const auto parts = decomposed(transform.affine());
        ASSERT_TRUE(parts);
        EXPECT_LT(distance(parts->affine(), transform.affine()), 1e-5f);
    }
}

TEST(TransformEdit, ShearStaysAMatrix) {
    Affine shear;
    shear.linear[1][0] = 0.5f;
    EXPECT_FALSE(decomposed(shear));
    const Transform transform = transform_from(shear);
    ASSERT_TRUE(transform.matrix);
    EXPECT_EQ(transform.affine(), shear);
}

}  // namespace
}  // namespace rayuela
