#include "core/accel/large_objects.h"

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

std::vector<std::uint32_t> find_large_objects(std::span<const TracedObject> objects, std::span<const Bounds3> bounds) {
    std::vector<std::uint32_t> found;
    Bounds3 rest;
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        if (bounds[i].empty() || !is_finite(bounds[i].lo) || !is_finite(bounds[i].hi)) continue;
        if (objects[i].mesh()) {
            rest.extend(bounds[i]);
        } else {
            found.push_back(i);
        }
    }
    const auto candidates = static_cast<std::ptrdiff_t>(std::min(found.size(), kLargeObjects));
    const auto larger = [&](std::uint32_t a, std::uint32_t b) {
        const double area_a = surface_area(bounds[a]), area_b = surface_area(bounds[b]);
        return area_a != area_b ? area_a > area_b : a < b;
    };
    std::ranges::partial_sort(found, found.begin() + candidates, larger);
    for (const std::uint32_t i : std::span(found).subspan(static_cast<std::size_t>(candidates))) rest.extend(bounds[i]);

    // rests[k] holds what is smaller than candidate k.
    std::vector<Bounds3> rests(static_cast<std::size_t>(candidates));
    for (std::size_t k = rests.size(); k-- > 0;) {
        rests[k] = rest;
        rest.extend(bounds[found[k]]);
    }
    std::size_t large = 0;
    while (large < rests.size() && surface_area(bounds[found[large]]) >= kShare * surface_area(rests[large])) ++large;
    found.resize(large);
    return found;
}

}  // namespace rayuela
