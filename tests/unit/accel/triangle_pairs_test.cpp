#include "core/accel/triangle_pairs.h"

#include <gmock/gmock.h>

namespace rayuela::test {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;
using Corners = std::array<Vec3, 3>;

Vec3 corner(const TrianglePair& pair, std::size_t i) {
    return {pair.corner[i][0], pair.corner[i][1], pair.corner[i][2]};
}

constexpr Vec3 kA(0, 0, 0), kB(1, 0, 0), kC(1, 2, 0), kD(0, 2, 0.5f), kFar(9, 9, 9);

TEST(TrianglePairs, WhatSharesAnEdgeIsAPair) {
    const Corners triangles[] = {{kA, kB, kC}, {kC, kD, kA}};
    const TrianglePairs found = pair_triangles(triangles);
    ASSERT_EQ(found.pairs.size(), 1u);
    EXPECT_EQ(found.of_two, 1u);
    EXPECT_THAT(found.names, ElementsAre(0, 1));
    const TrianglePair& pair = found.pairs[0];
    EXPECT_THAT((std::array{corner(pair, 0), corner(pair, 1)}), UnorderedElementsAre(kA, kC));
    EXPECT_EQ(corner(pair, 2), kB);
    EXPECT_EQ(corner(pair, 3), kD);
    EXPECT_THAT(pair.lo, ElementsAre(0, 0, 0, testing::_));
    EXPECT_THAT(pair.hi, ElementsAre(1, 2, 0.5f, testing::_));
    EXPECT_EQ(pair.extent, 2);
}

TEST(TrianglePairs, ACornerOrNothingInCommonIsNone) {
    const Corners triangles[] = {{kA, kB, kC}, {kC, kD, kFar}, {kFar, kFar + 1.0f, kFar + kB}};
    const TrianglePairs found = pair_triangles(triangles);
    EXPECT_EQ(found.of_two, 0u);
    ASSERT_EQ(found.pairs.size(), 3u);
    for (std::uint32_t k = 0; k < 3; ++k) {
        EXPECT_EQ(found.names[2 * k], k);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(corner(found.pairs[k], i), triangles[k][i]);
    }
}

TEST(TrianglePairs, ThreeAtAnEdgeLeaveOneAlone) {
    const Corners triangles[] = {{kA, kC, kB}, {kA, kC, kD}, {kA, kC, kFar}};
    const TrianglePairs found = pair_triangles(triangles);
    EXPECT_EQ(found.of_two, 1u);
    ASSERT_EQ(found.pairs.size(), 2u);
    EXPECT_THAT(found.names, ElementsAre(0, 1, 2, testing::_));
}

/// The same triangle twice shares three edges.
TEST(TrianglePairs, EachTriangleOnce) {
    const Corners triangles[] = {{kA, kB, kC}, {kB, kC, kA}, {kC, kB, kFar}, {kA, kA, kA}, {kA, kA, kB}};
    const TrianglePairs found = pair_triangles(triangles);
    std::vector<std::uint32_t> names;
    for (std::size_t k = 0; k < found.pairs.size(); ++k) {
        names.push_back(found.names[2 * k]);
        if (k < found.of_two) names.push_back(found.names[2 * k + 1]);
    }
    EXPECT_THAT(names, UnorderedElementsAre(0, 1, 2, 3, 4));
}

}  // namespace
}  // namespace rayuela::test
