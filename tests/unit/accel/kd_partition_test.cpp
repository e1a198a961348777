#include "core/accel/kd_partition.h"

#include "core/math/isa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

namespace rayuela::test {
namespace {

/// References to all triangles, each by its bounds.
struct Cut {
    TriangleMesh mesh;
    std::vector<KdReference> references;
    int axis = 0;
    float plane = 0;
};

/// Coordinates from a few values, so that vertices within the plane, flat triangles and points are common, or any.
Cut random_cut(std::mt19937& random) {
    Cut cut;
    const bool coarse = random() % 2 == 0;
    const float scale = std::ldexp(1.0f, static_cast<int>(random() % 200) - 100);
    const auto coordinate = [&] {
        return coarse ? scale * static_cast<float>(random() % 5)
                      : scale * std::uniform_real_distribution<float>(-1, 4)(random);
    };
    const auto triangles = static_cast<std::uint32_t>(1 + random() % 40);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        Bounds3 box;
        for (int corner = 0; corner < 3; ++corner) {
            box.extend(cut.mesh.positions.emplace_back(coordinate(), coordinate(), coordinate()));
        }
        cut.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        // Some were cut before.
        if (random() % 4 == 0) box.hi.y = std::max(box.lo.y, std::min(box.hi.y, coordinate()));
        cut.references.push_back({box, i, random() % 2 == 0});
    }
    cut.axis = static_cast<int>(random() % 3);
    cut.plane = coordinate();
    return cut;
}

auto key(const KdReference& r) {
    return std::tuple(r.primitive, r.owned, r.box.lo.x, r.box.lo.y, r.box.lo.z, r.box.hi.x, r.box.hi.y, r.box.hi.z);
}

std::vector<KdReference> sorted(std::vector<KdReference> references) {
    std::ranges::sort(references, {}, key);
    return references;
}

void expect_equal(const std::vector<KdReference>& a, const std::vector<KdReference>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(key(a[i]), key(b[i]));
}

TEST(KdPartition, SplitsAsOneAtATimeWithEveryInstructionSet) {
    std::mt19937 random(1);
    int both = 0;
    for (int round = 0; round < 3000; ++round) {
        const Cut cut = random_cut(random);
        const bool with_mesh = round % 4 != 0;
        std::vector<KdReference> below, above;
        for (const KdReference& r : cut.references) {
            const KdSides sides = split_reference(r, with_mesh ? &cut.mesh : nullptr, cut.axis, cut.plane);
            const bool reaches_below = !sides.below.empty(), reaches_above = !sides.above.empty();
            if (reaches_below) below.push_back({sides.below, r.primitive, r.owned});
            if (reaches_above) above.push_back({sides.above, r.primitive, reaches_below ? 0 : r.owned});
            both += reaches_below && reaches_above ? 1 : 0;
        }
        for (const std::string_view set : instruction_sets()) {
            SCOPED_TRACE(set);
            use_instruction_set(set);
            std::vector<KdReference> found_above = cut.references, found_below(cut.references.size());
            const KdPartCounts parts = partition_sah(found_above, with_mesh ? &cut.mesh : nullptr,
                                                     {.axis = cut.axis, .plane = cut.plane}, found_below.data());
            found_above.resize(parts.above);
            found_below.resize(parts.below);
            expect_equal(sorted(found_below), sorted(below));
            expect_equal(sorted(found_above), sorted(above));
        }
    }
    use_instruction_set(instruction_sets().front());
    EXPECT_GT(both, 1000);
}

TEST(KdPartition, PartsOfATriangleMeetInThePlane) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 8, 2}};
    mesh.triangles = {{0, 1, 2}};
    std::vector<KdReference> references = {{{{0, 0, 0}, {4, 8, 2}}, 0, 1}}, below(1);
    const KdPartCounts parts = partition_sah(references, &mesh, {.axis = 0, .plane = 1}, below.data());
    ASSERT_EQ(parts.below, 1u);
    ASSERT_EQ(parts.above, 1u);
    // At x = 1 the long edge is three quarters of its way down: y = 6, z = 1.5.
    EXPECT_EQ(key(below[0]), key({{{0, 0, 0}, {1, 8, 2}}, 0, 1}));
    EXPECT_EQ(key(references[0]), key({{{1, 0, 0}, {4, 6, 1.5f}}, 0, 0}));
}

}  // namespace
}  // namespace rayuela::test
