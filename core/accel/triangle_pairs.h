#pragma once

#include "core/math/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rayuela {

/// Two triangles that share an edge, so that a ray is held against four corners and five edges instead of six and six; or one.
struct TrianglePair {
    /// x, y and z of the ends of the edge, then of the first triangle's third corner and of the second's; each with a float
    /// that says nothing.
    float corner[4][4];
    float lo[4], hi[4];  ///< Bounds of both, alike.
    float extent;        ///< The largest of both along an axis.
};

/// Triangles in pairs, each once.
struct TrianglePairs {
    std::vector<TrianglePair> pairs;
    std::size_t of_two = 0;            ///< So many are two triangles; the others, behind them, are one.
    std::vector<std::uint32_t> names;  ///< Two a pair: the triangles' numbers; of a single one the second says nothing.

    std::uint64_t memory_bytes() const;
};

/// Pairs what shares an edge to the bit, in the order of the triangles. What finds no partner is left alone.
TrianglePairs pair_triangles(std::span<const std::array<Vec3, 3>> triangles);

}  // namespace rayuela
