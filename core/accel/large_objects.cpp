#include "core/accel/large_objects.h"

#include "core/accel/kd_builder.h"

#include <algorithm>

namespace rayuela {
namespace {

constexpr double kShare = 1.0 / 8;

double surface_area(const Bounds3& bounds) {
    if (bounds.empty()) return 0;
    const Vec3d e = Vec3d(bounds.hi) - Vec3d(bounds.lo);
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

}  // namespace

std::vector<std::uint32_t> find_large(std::span<const Bounds3> bounds, Bounds3 rest) {
    struct Candidate {
        double area;
        std::uint32_t index;
    };
    const auto larger = [](const Candidate& a, const Candidate& b) {
        return a.area != b.area ? a.area > b.area : a.index < b.index;
    };
    std::vector<Candidate> largest;  // A heap with the smallest on top.
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
        if (!fits_a_tree(bounds[i])) continue;
        const Candidate candidate{surface_area(bounds[i]), i};
        if (largest.size() < kLargePrimitives) {
            largest.push_back(candidate);
            std::ranges::push_heap(largest, larger);
        } else if (!larger(candidate, largest.front())) {
            rest.extend(bounds[i]);
        } else {
            std::ranges::pop_heap(largest, larger);
            rest.extend(bounds[largest.back().index]);
            largest.back() = candidate;
            std::ranges::push_heap(largest, larger);
        }
    }
    std::ranges::sort_heap(largest, larger);

    // rests[k] holds what is smaller than candidate k.
    std::vector<Bounds3> rests(largest.size());
    for (std::size_t k = rests.size(); k-- > 0;) {
        rests[k] = rest;
        rest.extend(bounds[largest[k].index]);
    }
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < largest.size() && largest[k].area >= kShare * surface_area(rests[k]); ++k)
        found.push_back(largest[k].index);
    return found;
}

std::vector<std::uint32_t> find_large_objects(std::span<const TracedObject> objects, std::span<const Bounds3> bounds) {
    std::vector<Bounds3> candidates(bounds.begin(), bounds.end());
    Bounds3 meshes;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (!objects[i].mesh()) continue;
        if (fits_a_tree(bounds[i])) meshes.extend(bounds[i]);
        candidates[i] = {};
    }
    return find_large(candidates, meshes);
}

}  // namespace rayuela
