#include "core/accel/kd_cut.h"

#include <algorithm>
#include <array>

namespace rayuela {

std::optional<KdCut> find_median_cut(std::span<const KdReference> references, const Bounds3& cell,
                                     std::span<const Bounds3> bounds, std::vector<std::uint32_t>& scratch) {
    scratch.clear();
    for (const KdReference& reference : references) {
        if (reference.owned) scratch.push_back(reference.primitive);
    }
    if (scratch.size() < 2) return {};
    std::array<int, 3> axes{0, 1, 2};
    const Vec3d extent = Vec3d(cell.hi) - Vec3d(cell.lo);
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] > extent[b]; });
    for (const int axis : axes) {
        const auto center = [&](std::uint32_t primitive) { return bounds[primitive].center()[axis]; };
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            return center(a) != center(b) ? center(a) < center(b) : a < b;
        };
        const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
        std::nth_element(scratch.begin(), middle, scratch.end(), before);
        const float above = center(*middle), below = center(*std::max_element(scratch.begin(), middle, before));
        const KdCut cut{.axis = axis, .plane = 0.5f * below + 0.5f * above, .pivot = above, .pivot_primitive = *middle};

        std::size_t on_both = 0;
        for (const KdReference& reference : references) {
            if (reference.box.lo[axis] < cut.plane && reference.box.hi[axis] > cut.plane) ++on_both;
        }
        const bool inside = cut.plane > cell.lo[axis] && cut.plane < cell.hi[axis];
        if (!inside || on_both == references.size()) continue;
        KdCut result = cut;
        result.duplicates = on_both;
        return result;
    }
    return {};
}

}  // namespace rayuela
