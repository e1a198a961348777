#include "core/accel/leaf_blocks.h"

#include "core/math/bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

namespace rayuela::test {
namespace {

std::vector<std::uint32_t> numbers(std::size_t n) {
    std::vector<std::uint32_t> result(n);
    std::iota(result.begin(), result.end(), 0u);
    return result;
}

/// A strip of n triangles over n + 2 vertices.
TriangleMesh strip(std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < n + 2; ++i) {
        const auto x = static_cast<float>(i);
        mesh.positions.emplace_back(x, i % 2 == 0 ? 0.0f : 1.0f, 0.01f * x * x);
    }
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.emplace_back(i, i + 1, i + 2);
    return mesh;
}

/// Triangles of all sizes that share no vertex.
TriangleMesh soup(std::uint32_t n) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1, 1);
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 3 * n; ++i) {
        const float size = std::exp2(20 * unit(random));
        mesh.positions.emplace_back(size * unit(random), size * unit(random), size * unit(random));
    }
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    return mesh;
}

bool same_bits(float a, float b) {
    return std::memcmp(&a, &b, sizeof(float)) == 0;
}

/// Reads the blocks back, holds them to the mesh and returns how many there are of each kind.
struct Read {
    std::size_t shared = 0, runs = 0;

    Read(const TriangleMesh& mesh, std::span<const std::uint32_t> names) {
        UnsetVector<float> data;
        append_leaf_blocks(mesh, names, data);
        std::size_t at = 0, done = 0;
        while (at < data.size() && done < names.size()) {
            const LeafBlock block(data.data() + at);
            EXPECT_GT(block.triangles(), 0u);
            EXPECT_LE(block.triangles(), LeafBlock::kMaxTriangles);
            EXPECT_LE(block.vertices(), LeafBlock::kMaxVertices);
            ++(block.vertices() > 0 ? shared : runs);
            for (std::uint32_t i = 0; i < block.triangles(); ++i) {
                EXPECT_EQ(block.name(i), names[done + i]);
                check(mesh, names[done + i], block, i);
            }
            done += block.triangles();
            EXPECT_EQ(block.size() % LeafBlock::kUnit, 0u);
            at += block.size();
        }
        EXPECT_EQ(done, names.size());
        EXPECT_EQ(at, data.size());
    }

private:
    static void check(const TriangleMesh& mesh, std::uint32_t triangle, const LeafBlock& block, std::uint32_t i) {
        const CornerView view = CornerView::of(block).from(i);
        Bounds3 bounds;
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3& expected = mesh.positions[mesh.triangles[triangle][corner]];
            bounds.extend(expected);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_TRUE(
                    same_bits(view.coordinate(0, static_cast<std::size_t>(corner), static_cast<std::size_t>(axis)),
                              expected[axis]));
            }
        }
        if (block.vertices() == 0) return;
        const float extent = max_component(bounds.extent()), kept = LeafBlock::extent(block.corners()[i]);
        if (!std::isfinite(extent)) return;
        EXPECT_GE(kept, extent);
        EXPECT_LE(kept, std::max(2 * extent, 0x1p-126f));
        int exponent = 0;
        EXPECT_TRUE(kept == 0 || std::frexp(kept, &exponent) == 0.5f) << "a power of two";
    }
};

TEST(LeafBlocks, HoldEachVertexOnceWhereTrianglesShareThem) {
    const TriangleMesh mesh = strip(14);
    const Read read(mesh, numbers(14));
    EXPECT_EQ(read.shared, 1u);
    EXPECT_EQ(read.runs, 0u);
}

TEST(LeafBlocks, OfAnySizeHoldEachTriangle) {
    for (std::uint32_t n = 0; n <= 70; ++n) {
        const Read shared(strip(n), numbers(n));
        EXPECT_EQ(shared.runs, 0u);
        // 14 triangles of a strip have 16 vertices.
        EXPECT_EQ(shared.shared, (n + 13) / 14);
    }
}

TEST(LeafBlocks, KeepTheNamesOfTheirTriangles) {
    std::vector<std::uint32_t> backwards = numbers(40);
    std::ranges::reverse(backwards);
    EXPECT_EQ(Read(strip(40), backwards).runs, 0u);
    EXPECT_EQ(Read(soup(40), backwards).shared, 0u);
}

TEST(LeafBlocks, AreRunsWhereTrianglesShareTooLittle) {
    for (std::uint32_t n = 6; n <= 70; ++n) {
        const Read read(soup(n), numbers(n));
        EXPECT_EQ(read.runs, n % 16 == 0 || n % 16 > 5 ? (n + 15) / 16 : n / 16);
        EXPECT_EQ(read.shared, n % 16 > 0 && n % 16 <= 5 ? 1u : 0u) << "five triangles have fifteen vertices";
    }
}

TEST(LeafBlocks, KeepThePositionsOfVerticesBitByBit) {
    TriangleMesh mesh;
    const float nan = std::nanf("");
    mesh.positions = {Vec3(0), Vec3(-0.0f, 0, 0), Vec3(nan, 0, 0), Vec3(0), Vec3(kInfinity, 1e-42f, -1e-42f)};
    mesh.triangles = {{0, 1, 2}, {3, 1, 4}, {2, 2, 2}, {3, 0, 3}};
    const Read read(mesh, numbers(4));
    EXPECT_EQ(read.shared, 1u);
}

}  // namespace
}  // namespace rayuela::test
