#include "assets/generators/duck.h"

#include "assets/generators/mesh_file.h"
#include "tests/unit/assets/mesh_checks.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace rayuela {
namespace {

std::string committed(const std::string& name) {
    std::ifstream file(std::string(RAYUELA_ASSETS_DIR "/meshes/") + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Duck, HasSeveralThousandTriangles) {
    const std::size_t triangles = assets::make_duck_body().triangles.size() + assets::make_duck_bill().triangles.size();
    EXPECT_GE(triangles, 8'000u);
    EXPECT_LE(triangles, 18'000u);
}

TEST(Duck, PartsAreSolidBodiesThatFaceOutward) {
    for (const TriangleMesh& part : {assets::make_duck_body(), assets::make_duck_bill()}) {
        EXPECT_TRUE(is_closed_and_oriented(part));
        EXPECT_EQ(euler_characteristic(part), 2) << "one part without handles";
        EXPECT_GT(volume(part), 0);
    }
}

TEST(Duck, BodyLiesOnItsImplicitSurfaceAndOnTheFloor) {
    const TriangleMesh body = assets::make_duck_body();
    for (const Vec3& p : body.positions) EXPECT_NEAR(assets::duck_body(Vec3d(p)), 0, 1e-3);
    EXPECT_NEAR(body.bounds.lo.y, 0, 1e-3);
}

TEST(Duck, NormalsAreUnitAndAgreeWithTheFaces) {
    const TriangleMesh body = assets::make_duck_body();
    for (const Vec3& n : body.normals) EXPECT_NEAR(glm::length(n), 1, 1e-5);
    EXPECT_GT(worst_normal_cosine(body), 0.2);
}

TEST(Duck, CommittedFilesAreWhatTheGeneratorWrites) {
    EXPECT_EQ(committed("duck_body.obj"), assets::to_obj(assets::make_duck_body(), assets::kDuckComment));
    EXPECT_EQ(committed("duck_bill.obj"), assets::to_obj(assets::make_duck_bill(), assets::kDuckComment));
}

}  // namespace
}  // namespace rayuela
