#include "assets/generators/dragon.h"

#include "assets/generators/mesh_file.h"
#include "tests/unit/assets/mesh_checks.h"

#include <gmock/gmock.h>

#include <cstring>
#include <string>

namespace rayuela {
namespace {

TEST(Dragon, HasAtLeastTheTrianglesAskedFor) {
    for (const std::size_t asked : {10'000u, 100'000u, 300'000u}) {
        const std::size_t got = assets::make_dragon(asked).triangles.size();
        EXPECT_GE(got, asked);
        EXPECT_LE(got, asked + asked / 2);
    }
}

TEST(Dragon, IsMadeOfClosedPartsThatFaceOutward) {
    const TriangleMesh dragon = assets::make_dragon(50'000);
    EXPECT_TRUE(is_closed_and_oriented(dragon));
    EXPECT_EQ(euler_characteristic(dragon) % 2, 0);
    EXPECT_GT(volume(dragon), 0);
    for (const Vec3& n : dragon.normals) EXPECT_NEAR(glm::length(n), 1, 1e-5);
}

TEST(Tube, OfConstantRadiusHasTheVolumeOfACylinder) {
    const assets::Tube tube({{{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.5}, {{2, 0, 0}, 0.5}});
    TriangleMesh mesh;
    assets::add_skin(mesh, tube, 400, 128, [](double, double) { return 0.0; });
    assets::finish(mesh);
    EXPECT_NEAR(tube.length(), 2, 1e-9);
    EXPECT_NEAR(volume(mesh), 2 * kPi * 0.25, 0.01);
}

TEST(Ply, HoldsTheBytesOfTheMesh) {
    TriangleMesh mesh;
    mesh.positions = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
    mesh.triangles = {{0, 1, 2}};
    assets::finish(mesh);
    const std::string ply = assets::to_ply(mesh, "test");
    EXPECT_THAT(ply, testing::StartsWith("ply\nformat binary_little_endian 1.0\ncomment test\nelement vertex 3\n"));
    const std::size_t body = ply.find("end_header\n") + 11;
    ASSERT_EQ(ply.size() - body, 3 * 24 + 13u);
    float x = 0;
    std::memcpy(&x, ply.data() + body + 24, sizeof x);
    EXPECT_EQ(x, 4);
    EXPECT_EQ(ply[body + 72], 3);
}

}  // namespace
}  // namespace rayuela
