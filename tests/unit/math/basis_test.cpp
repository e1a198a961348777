#include "core/math/basis.h"

#include "core/math/sampler.h"
#include "core/math/sampling.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace rayuela {
namespace {

/// Mean square of what the six scalar products deviate from those of an orthonormal basis.
double deviation(const Basis& f) {
    const Vec3d s(f.s), t(f.t), n(f.n);
    double sum = 0;
    for (const Vec3d& v : {s, t, n}) sum += std::pow(glm::dot(v, v) - 1, 2);
    return sum + std::pow(glm::dot(s, t), 2) + std::pow(glm::dot(t, n), 2) + std::pow(glm::dot(n, s), 2);
}

TEST(Basis, OrthonormalAndRightHanded) {
    double sum = 0;
    constexpr std::uint32_t kCount = 100'000;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const Vec3 n = glm::normalize(sample_uniform_sphere(Sampler(SamplerKind::independent, 0, 0, i).get_2d(0)));
        const Basis frame(n);
        sum += deviation(frame);
        ASSERT_GT(glm::dot(glm::cross(frame.s, frame.t), frame.n), 0.999f);
        ASSERT_LT(glm::length(frame.to_world(frame.to_local(Vec3(0.3f, -0.4f, 0.8f))) - Vec3(0.3f, -0.4f, 0.8f)),
                  1e-6f);
    }
    EXPECT_LE(sum / kCount, 1e-13);
}

TEST(Basis, KnownBadNormals) {
    // Around the pole at which Frisvad's basis breaks down, and both signs of zero.
    for (const Vec3& n : {Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(0.00038527316f, 0.00038460016f, -0.99999988079f),
                          Vec3(-0.00019813581f, -0.00008946839f, -0.99999999f), Vec3(1, 0, 0.0f), Vec3(1, 0, -0.0f),
                          Vec3(0, -1, -0.0f), Vec3(1e-20f, 0, -1)}) {
        const Vec3 unit(glm::normalize(Vec3d(n)));
        EXPECT_LT(deviation(Basis(unit)), 1e-12) << n.x << " " << n.y << " " << n.z;
        EXPECT_EQ(Basis(unit).to_world(Vec3(0, 0, 1)), unit);
    }
}

}  // namespace
}  // namespace rayuela
