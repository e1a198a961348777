#include "core/accel/triangle_pairs.h"

#include "core/math/bounds.h"

#include <algorithm>
#include <map>

namespace rayuela {
namespace {

using Corners = std::array<Vec3, 3>;
using Edge = std::array<float, 6>;  ///< Its ends, the lesser first.

Edge edge(const Corners& triangle, std::size_t i) {
    const auto numbers = [](const Vec3& v) { return std::array{v.x, v.y, v.z}; };
    const auto [a, b] = std::minmax({numbers(triangle[i]), numbers(triangle[(i + 1) % 3])});
    return {a[0], a[1], a[2], b[0], b[1], b[2]};
}

/// Of a triangle and the edge from corner i on, beside a second one that may be the same.
TrianglePair make_pair(const Corners& first, std::size_t i, const Vec3& second_apex) {
    const Vec3 corners[4] = {first[i], first[(i + 1) % 3], first[(i + 2) % 3], second_apex};
    TrianglePair pair{};
    Bounds3 bounds;
    for (int k = 0; k < 4; ++k) {
        bounds.extend(corners[k]);
        for (int axis = 0; axis < 3; ++axis) pair.corner[k][axis] = corners[k][axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
        pair.lo[axis] = bounds.lo[axis];
        pair.hi[axis] = bounds.hi[axis];
    }
    pair.extent = max_component(bounds.extent());
    return pair;
}

/// An edge of a triangle: that from its corner i on.
struct EdgeOf {
    std::uint32_t triangle;
    std::size_t i;
};

}  // namespace

std::uint64_t TrianglePairs::memory_bytes() const {
    return pairs.size() * sizeof(TrianglePair) + names.size() * sizeof(std::uint32_t);
}

TrianglePairs pair_triangles(std::span<const Corners> triangles) {
    TrianglePairs result;
    std::map<Edge, EdgeOf> single;
    std::vector<bool> paired(triangles.size());
    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
        const Corners& triangle = triangles[k];
        for (std::size_t i = 0; i < 3 && !paired[k]; ++i) {
            const auto found = single.find(edge(triangle, i));
            if (found == single.end() || paired[found->second.triangle]) continue;
            const EdgeOf other = found->second;
            result.pairs.push_back(make_pair(triangles[other.triangle], other.i, triangle[(i + 2) % 3]));
            result.names.insert(result.names.end(), {other.triangle, k});
            paired[k] = paired[other.triangle] = true;
        }
        for (std::size_t i = 0; i < 3 && !paired[k]; ++i) single.insert_or_assign(edge(triangle, i), EdgeOf{k, i});
    }
    result.of_two = result.pairs.size();
    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
        if (paired[k]) continue;
        result.pairs.push_back(make_pair(triangles[k], 0, triangles[k][2]));
        result.names.insert(result.names.end(), {k, k});
    }
    return result;
}

}  // namespace rayuela
