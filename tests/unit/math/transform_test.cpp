#include "core/math/transform.h"

#include "core/math/basis.h"
#include "core/math/float_error.h"
#include "core/math/precise.h"

#include <gtest/gtest.h>

#include <random>

namespace rayuela {
namespace {

Vec3 random_vec(std::mt19937& engine, float half = 1) {
    std::uniform_real_distribution<float> d(-half, half);
    return {d(engine), d(engine), d(engine)};
}

Affine random_affine(std::mt19937& engine) {
    Mat3 m(1);
    for (int i = 0; i < 3; ++i) m[i] += random_vec(engine, 0.4f);
    return {m, random_vec(engine, 5)};
}

TEST(Affine, InverseAndCompositionUndoAndChain) {
    std::mt19937 engine(1);
    for (int i = 0; i < 1000; ++i) {
        const Affine a = random_affine(engine), b = random_affine(engine);
        const Vec3 p = random_vec(engine, 10);
        EXPECT_LT(glm::length(a.inverse().point(a.point(p)) - p), 2e-5f);
        EXPECT_LT(glm::length((a * b).point(p) - a.point(b.point(p))), 2e-5f);
        EXPECT_LT(glm::length(Vec3(AffineD(a).inverse().point(AffineD(a).point(Vec3d(p)))) - p), 1e-6f);
    }
}

TEST(Affine, KnowsIdentityAndSingular) {
    EXPECT_TRUE(Affine().is_identity());
    EXPECT_FALSE((Affine{Mat3(1), Vec3(0, 1e-30f, 0)}).is_identity());
    EXPECT_TRUE((Affine{Mat3(1e-12f), Vec3(0)}).is_invertible());
    Mat3 flat(1);
    flat[2][2] = 0;
    EXPECT_FALSE((Affine{flat, Vec3(0)}).is_invertible());
    EXPECT_FALSE((Affine{Mat3(1), Vec3(NAN)}).is_invertible());
}

TEST(Affine, BoundsHoldTheTransformedPoints) {
    std::mt19937 engine(2);
    for (int i = 0; i < 200; ++i) {
        const Affine a = random_affine(engine);
        Bounds3 box;
        box.extend(random_vec(engine));
        box.extend(random_vec(engine));
        const Bounds3 mapped = a.bounds(box);
        for (int k = 0; k < 20; ++k) {
            const Vec3 s = 0.5f * (random_vec(engine) + Vec3(1));
            const Vec3 p = a.point(box.lo + s * (box.hi - box.lo));
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(p[axis], mapped.lo[axis] - 1e-5f);
                EXPECT_LE(p[axis], mapped.hi[axis] + 1e-5f);
            }
        }
    }
    EXPECT_TRUE(Affine().bounds(Bounds3()).empty());
}

TEST(Transform, ScalesThenRotatesThenTranslates) {
    Transform t;
    t.scale = Vec3(2, 1, 1);
    t.rotate = glm::angleAxis(glm::radians(90.0f), Vec3(0, 0, 1));
    t.translate = Vec3(0, 0, 5);
    const Vec3 p = t.affine().point(Vec3(1, 0, 0));
    EXPECT_LT(glm::length(p - Vec3(0, 2, 5)), 1e-6f);
    t.matrix = Mat4(1);
    (*t.matrix)[3] = Vec4(1, 2, 3, 1);
    EXPECT_EQ(t.affine().point(Vec3(1)), Vec3(2, 3, 4)) << "the matrix replaces the three";
}

TEST(RayD, TransformKeepsTheParameter) {
    std::mt19937 engine(3);
    for (int i = 0; i < 100; ++i) {
        const AffineD a(random_affine(engine));
        const RayD ray{Vec3d(random_vec(engine)), Vec3d(random_vec(engine))};
        EXPECT_LT(glm::length(a.ray(ray).at(2.5) - a.point(ray.at(2.5))), 1e-12);
    }
}

TEST(Bounds, EmptyIsTheIdentityOfExtend) {
    Bounds3 bounds;
    EXPECT_TRUE(bounds.empty());
    EXPECT_EQ(bounds.extent(), Vec3(0));
    EXPECT_EQ(bounds.surface_area(), 0);
    const Bounds3 unit{Vec3(0), Vec3(1, 2, 3)};
    bounds.extend(unit);
    bounds.extend(Bounds3());
    EXPECT_EQ(bounds.lo, unit.lo);
    EXPECT_EQ(bounds.hi, unit.hi);
    EXPECT_EQ(bounds.surface_area(), 22);
    EXPECT_EQ(bounds.longest_axis(), 2);
    EXPECT_EQ(bounds.center(), Vec3(0.5f, 1, 1.5f));
    EXPECT_TRUE(bounds.contains(bounds.hi));
    EXPECT_FALSE(bounds.contains(Vec3(0, 0, 3.1f)));
    EXPECT_TRUE((Bounds3{Vec3(NAN), Vec3(1)}).empty());
}

TEST(FloatError, OffsetMovesBeyondTheErrorToTheRightSide) {
    std::mt19937 engine(4);
    for (int i = 0; i < 10000; ++i) {
        const Vec3 p = random_vec(engine, 100), n = glm::normalize(random_vec(engine)), w = random_vec(engine);
        const Vec3 error = kUnitRoundoff * glm::abs(p);
        const Vec3 origin = offset_ray_origin(p, error, n, w);
        const double moved = glm::dot(Vec3d(origin) - Vec3d(p), Vec3d(n));
        const double needed = glm::dot(Vec3d(glm::abs(n)), Vec3d(error));
        if (glm::dot(w, n) >= 0) {
            EXPECT_GE(moved, needed);
        } else {
            EXPECT_LE(moved, -needed);
        }
    }
}

TEST(Basis, IsOrthonormalForAnyUnitNormal) {
    std::mt19937 engine(5);
    double squared = 0;
    int count = 0;
    const auto check = [&](const Vec3& n) {
        const Basis f(n);
        const Mat3 m(f.s, f.t, f.n);
        const Mat3 e = glm::transpose(m) * m - Mat3(1);
        for (int i = 0; i < 3; ++i) squared += glm::dot(e[i], e[i]), count += 3;
        EXPECT_GT(glm::determinant(m), 0.99f);
    };
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, -0.0f, -1), Vec3(1e-7f, 0, -1), Vec3(1, 0, 0)})
        check(n);
    for (int i = 0; i < 100000; ++i) check(glm::normalize(random_vec(engine)));
    EXPECT_LT(squared / count, 1e-13);
}

}  // namespace
}  // namespace rayuela
