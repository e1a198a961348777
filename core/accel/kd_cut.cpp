#include "core/accel/kd_cut.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {
namespace {

constexpr int kBins = 32;
constexpr std::size_t kExactLimit = 32;
constexpr double kEmptyBonus = 0.8;

/// Chances that a ray through a cell passes the parts beside a plane.
class CellMeasure {
public:
    explicit CellMeasure(const Bounds3& cell) : lo_(cell.lo), extent_(Vec3d(cell.hi) - Vec3d(cell.lo)) {}

    /// Of the part from the cell's lower side to `plane`, in proportion to `whole`.
    double below(int axis, float plane) const { return of(axis, plane - lo_[axis]); }
    double above(int axis, float plane) const { return of(axis, extent_[axis] - (plane - lo_[axis])); }
    double whole() const { return of(0, extent_.x); }

private:
    /// Half the surface area, or the length where the cell has no area.
    double of(int axis, double depth) const {
        Vec3d e = extent_;
        e[axis] = depth;
        const Vec3d& full = extent_;
        if (full.x * full.y + full.y * full.z + full.z * full.x > 0) return e.x * e.y + e.y * e.z + e.z * e.x;
        return e.x + e.y + e.z;
    }

    Vec3d lo_, extent_;
};

class CutSearch {
public:
    CutSearch(const Bounds3& cell, std::size_t references, float step_cost)
        : cell_(cell), measure_(cell), references_(references), step_cost_(step_cost) {}

    void consider(int axis, float plane, std::size_t below, std::size_t above) {
        if (!(plane > cell_.lo[axis] && plane < cell_.hi[axis])) return;
        const double tests = measure_.below(axis, plane) * static_cast<double>(below) +
                             measure_.above(axis, plane) * static_cast<double>(above);
        const double bonus = below == 0 || above == 0 ? kEmptyBonus : 1;
        const double cost = bonus * (step_cost_ + tests / measure_.whole());
        if (!best_ || cost < best_->cost) {
            best_ = KdCut{.axis = axis, .plane = plane, .cost = cost, .duplicates = below + above - references_};
        }
    }
    std::optional<KdCut> best() const { return best_; }

private:
    Bounds3 cell_;
    CellMeasure measure_;
    std::size_t references_;
    double step_cost_;
    std::optional<KdCut> best_;
};

/// Every plane at which a box begins or ends.
void search_exact(std::span<const KdReference> references, CutSearch& search) {
    std::array<float, kExactLimit> begins, ends;
    const std::size_t n = references.size();
    for (int axis = 0; axis < 3; ++axis) {
        std::array<float, kExactLimit> flat;
        std::size_t flats = 0;
        for (std::size_t i = 0; i < n; ++i) {
            begins[i] = references[i].box.lo[axis];
            ends[i] = references[i].box.hi[axis];
            if (begins[i] == ends[i]) flat[flats++] = begins[i];
        }
        std::sort(begins.begin(), begins.begin() + n);
        std::sort(ends.begin(), ends.begin() + n);
        const auto sweep = [&](const std::array<float, kExactLimit>& planes) {
            std::size_t begun = 0, ended = 0;
            for (std::size_t i = 0; i < n; ++i) {
                const float plane = planes[i];
                if (i > 0 && plane == planes[i - 1]) continue;
                while (begun < n && begins[begun] < plane) ++begun;
                while (ended < n && ends[ended] <= plane) ++ended;
                const auto within = std::count(flat.begin(), flat.begin() + flats, plane);
                search.consider(axis, plane, begun + static_cast<std::size_t>(within), n - ended);
            }
        };
        sweep(begins);
        sweep(ends);
    }
}

struct Bins {
    std::array<std::array<std::uint32_t, kBins>, 3> begin{}, end{};
};

/// Planes at equal distances over what the node holds, so that the outermost cut off empty space.
void search_binned(std::span<const KdReference> references, CutSearch& search) {
    Bounds3 held;
    for (const KdReference& reference : references) held.extend(reference.box);
    const Vec3 extent = held.hi - held.lo;
    const Vec3 per_unit = float{kBins} / extent;
    // Axes too flat or too long to be divided in float are left alone.
    const auto divisible = [&](int axis) { return per_unit[axis] > 0 && per_unit[axis] < kInfinity; };
    Bins bins;
    for (const KdReference& reference : references) {
        const Vec3 lo = (reference.box.lo - held.lo) * per_unit, hi = (reference.box.hi - held.lo) * per_unit;
        for (int axis = 0; axis < 3; ++axis) {
            if (!divisible(axis)) continue;
            // A box that ends at a plane is not above it; a flat one within the plane is below it.
            const int last = static_cast<int>(std::ceil(std::min(hi[axis], float{kBins}))) - 1;
            const int end = std::max(last, 0);
            const int begin = std::clamp(static_cast<int>(lo[axis]), 0, end);
            ++bins.begin[static_cast<std::size_t>(axis)][static_cast<std::size_t>(begin)];
            ++bins.end[static_cast<std::size_t>(axis)][static_cast<std::size_t>(end)];
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (!divisible(axis)) continue;
        std::size_t below = 0, above = references.size();
        for (int k = 0; k <= kBins; ++k) {
            const float plane = k == kBins ? held.hi[axis] : held.lo[axis] + static_cast<float>(k) / per_unit[axis];
            search.consider(axis, plane, below, above);
            if (k == kBins) break;
            below += bins.begin[static_cast<std::size_t>(axis)][static_cast<std::size_t>(k)];
            above -= bins.end[static_cast<std::size_t>(axis)][static_cast<std::size_t>(k)];
        }
    }
}

}  // namespace

std::optional<KdCut> find_sah_cut(std::span<const KdReference> references, const Bounds3& cell, float step_cost) {
    CutSearch search(cell, references.size(), step_cost);
    if (references.size() <= kExactLimit) {
        search_exact(references, search);
    } else {
        search_binned(references, search);
    }
    return search.best();
}

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
