#include "core/accel/kd_cut.h"
#include "core/math/isa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

namespace rayuela::test {
namespace {

/// Bins of boxes that span this are two wide, their planes exact.
constexpr int kSpan = 64;
constexpr std::size_t kMostExact = 64;

/// Boxes with whole coordinates, a third of them flat along an axis, that span 0 to kSpan.
std::vector<KdReference> random_references(std::size_t count, std::mt19937& random) {
    const auto whole = [&] { return static_cast<float>(random() % (kSpan + 1)); };
    std::vector<KdReference> references(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Bounds3& box = references[i].box;
        box.extend(Vec3(whole(), whole(), whole()));
        box.hi = glm::min(box.lo + glm::floor(Vec3(whole(), whole(), whole()) / 8.0f), Vec3(kSpan));
        if (const int axis = static_cast<int>(random() % 9); axis < 3) box.hi[axis] = box.lo[axis];
        references[i].primitive = i;
    }
    references.front().box.lo = Vec3(0);
    references.back().box.hi = Vec3(kSpan);
    return references;
}

struct Sides {
    std::size_t below = 0, above = 0;
};

Sides sides_of(const std::vector<KdReference>& references, int axis, float plane) {
    Sides sides;
    for (const KdReference& reference : references) {
        const float lo = reference.box.lo[axis], hi = reference.box.hi[axis];
        sides.below += lo < plane || hi <= plane ? 1 : 0;
        sides.above += hi > plane ? 1 : 0;
    }
    return sides;
}

double area_of(const Bounds3& cell) {
    const Vec3d e = Vec3d(cell.hi) - Vec3d(cell.lo);
    return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// Infinite where the plane does not lie within the cell.
double cost_of(const std::vector<KdReference>& references, const Bounds3& cell, int axis, float plane) {
    if (!(plane > cell.lo[axis] && plane < cell.hi[axis])) return INFINITY;
    const Sides sides = sides_of(references, axis, plane);
    Bounds3 below = cell, above = cell;
    below.hi[axis] = above.lo[axis] = plane;
    const double tests =
        area_of(below) * static_cast<double>(sides.below) + area_of(above) * static_cast<double>(sides.above);
    return (sides.below == 0 || sides.above == 0 ? 0.8 : 1.0) * (1 + tests / area_of(cell));
}

/// Where a box begins: a flat one just before the plane in which it lies.
float begin_of(const Bounds3& box, int axis) {
    return box.lo[axis] < box.hi[axis] ? box.lo[axis] : std::nextafter(box.lo[axis], -INFINITY);
}

/// The least cost of the planes across an axis, between two others, at which a box begins or ends.
double least_between(const std::vector<KdReference>& references, const Bounds3& cell, int axis, float first,
                     float last) {
    double least = INFINITY;
    for (const KdReference& reference : references) {
        for (const float plane : {begin_of(reference.box, axis), reference.box.hi[axis]}) {
            if (plane > first && plane < last) least = std::min(least, cost_of(references, cell, axis, plane));
        }
    }
    return least;
}

bool about(double a, double b) {
    return std::abs(a - b) <= 1e-12 * b;
}

/// What the cheapest cut across an axis beside its best bin may cost: of as good bins each may be the best.
std::vector<double> costs_beside_bins(const std::vector<KdReference>& references, const Bounds3& cell, int axis) {
    constexpr int kWidth = kSpan / 32;
    const auto cost_of_bin = [&](int k) { return cost_of(references, cell, axis, static_cast<float>(k)); };
    double best = INFINITY;
    for (int k = 0; k <= kSpan; k += kWidth) best = std::min(best, cost_of_bin(k));
    std::vector<double> costs{best};
    for (int k = 0; k <= kSpan; k += kWidth) {
        if (!about(cost_of_bin(k), best)) continue;
        // The outermost bins reach to the sides of the cell.
        const float first = k > 0 ? static_cast<float>(k - kWidth) : cell.lo[axis];
        const float last = k < kSpan ? static_cast<float>(k + kWidth) : cell.hi[axis];
        costs.push_back(std::min(best, least_between(references, cell, axis, first, last)));
    }
    return costs;
}

/// What the cheapest cut may cost. Of large nodes, cuts by bins are made cheaper that cost up to 1.1 times the best.
std::vector<double> least_costs(const std::vector<KdReference>& references, const Bounds3& cell) {
    double least = INFINITY;
    if (references.size() <= kMostExact) {
        for (int axis = 0; axis < 3; ++axis)
            least = std::min(least, least_between(references, cell, axis, -INFINITY, INFINITY));
        return {least};
    }
    std::vector<double> costs[3];
    for (int axis = 0; axis < 3; ++axis) {
        costs[axis] = costs_beside_bins(references, cell, axis);
        least = std::min(least, costs[axis].front());
    }
    std::vector<double> all;
    double most = INFINITY;
    for (const std::vector<double>& of_axis : costs) {
        if (of_axis.front() > 1.1 * least) continue;
        const auto beside = std::span(of_axis).subspan(1);
        all.insert(all.end(), beside.begin(), beside.end());
        if (!beside.empty()) most = std::min(most, std::ranges::max(beside));
    }
    std::erase_if(all, [&](double cost) { return cost > most; });
    return all;
}

}  // namespace

/// Also where a byte no longer holds the counts of bins.
TEST(SahCut, IsTheCheapestWithEveryInstructionSet) {
    std::mt19937 random(1);
    for (const std::size_t count :
         {1u, 2u, 3u, 7u, 16u, 17u, 33u, 63u, 64u, 65u, 255u, 256u, 257u, 510u, 511u, 1500u}) {
        for (int round = 0; round < 20; ++round) {
            const auto references = random_references(count, random);
            Bounds3 cell{Vec3(0), Vec3(kSpan)};
            if (round % 2 != 0) cell.extend(Vec3(-3, kSpan + 5, 7));
            const std::vector<double> least = least_costs(references, cell);
            for (const std::string_view isa : instruction_sets()) {
                use_instruction_set(isa);
                const auto cut = find_sah_cut(references, cell, 1);
                ASSERT_EQ(cut.has_value(), !least.empty() && least.front() < INFINITY) << isa << ' ' << count;
                if (!cut) continue;
                EXPECT_TRUE(std::ranges::any_of(least, [&](double cost) { return about(cut->cost, cost); }))
                    << isa << ' ' << count << ": " << cut->cost << " instead of " << least.front();
                EXPECT_TRUE(about(cut->cost, cost_of(references, cell, cut->axis, cut->plane))) << isa << ' ' << count;
                const Sides sides = sides_of(references, cut->axis, cut->plane);
                EXPECT_EQ(cut->duplicates, sides.below + sides.above - count) << isa << ' ' << count;
            }
        }
    }
    use_instruction_set(instruction_sets().front());
}

/// By the order of axes and planes, not by which lanes they come to.
TEST(SahCut, OfEqualCutsIsTheFirstWithEveryInstructionSet) {
    const Bounds3 cell{Vec3(0), Vec3(kSpan)};
    for (const std::size_t count : {8u, 128u}) {
        // As good along each axis and from either end.
        std::vector<KdReference> references(count);
        for (std::size_t i = 0; i < count; ++i) {
            const float at = i % 2 == 0 ? 8 : kSpan - 16;
            references[i].box = {Vec3(at), Vec3(at + 8)};
        }
        // Where boxes begin comes before where they end; bins, 1.5 wide from 8 on, come in their order.
        const float first = count <= kMostExact ? 48 : 17;
        EXPECT_EQ(cost_of(references, cell, 0, first), cost_of(references, cell, 0, kSpan - first));
        for (const std::string_view isa : instruction_sets()) {
            use_instruction_set(isa);
            const auto cut = find_sah_cut(references, cell, 1);
            ASSERT_TRUE(cut);
            EXPECT_EQ(cut->axis, 0) << isa << ' ' << count;
            EXPECT_EQ(cut->plane, first) << isa << ' ' << count;
        }
    }
    use_instruction_set(instruction_sets().front());
}

}  // namespace rayuela::test
