#include "core/accel/kd_split.h"

#include <algorithm>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/kd_split.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/lane_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr std::size_t kAtOnce = hn::MaxLanes(DoubleTag());
using NarrowTag = hn::Rebind<float, DoubleTag>;
using Narrow = hn::Vec<NarrowTag>;
using NarrowMask = hn::Mask<NarrowTag>;
using NarrowRow = float[kAtOnce];

/// Axis 0 is that of the plane.
struct NarrowPoint {
    Narrow at[3];
};

/// The number of each axis, first that of the plane.
struct Axes {
    std::size_t at[3];

    explicit Axes(std::size_t first) : at{first, (first + 1) % 3, (first + 2) % 3} {}
};

/// Boxes with their triangles; zeros where none was put.
struct CutBlock {
    alignas(64) NarrowRow lo[3], hi[3], vertex[3][3];

    HWY_INLINE CutBlock() {
        const NarrowTag d;
        for (std::size_t i = 0; i < 3; ++i) {
            hn::Store(hn::Zero(d), d, lo[i]);
            hn::Store(hn::Zero(d), d, hi[i]);
            for (auto& corner : vertex) hn::Store(hn::Zero(d), d, corner[i]);
        }
    }
    HWY_INLINE void put(std::size_t k, const KdReference& reference, const TriangleMesh& mesh, const Axes& axes) {
        const glm::uvec3& t = mesh.triangles[reference.primitive];
        const float* const corners[3] = {&mesh.positions[t.x].x, &mesh.positions[t.y].x, &mesh.positions[t.z].x};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t from = axes.at[i];
            lo[i][k] = (&reference.box.lo.x)[from];
            hi[i][k] = (&reference.box.hi.x)[from];
            for (std::size_t v = 0; v < 3; ++v) vertex[v][i][k] = corners[v][from];
        }
    }
    HWY_INLINE NarrowPoint corner(std::size_t v) const {
        const NarrowTag d;
        return {hn::Load(d, vertex[v][0]), hn::Load(d, vertex[v][1]), hn::Load(d, vertex[v][2])};
    }
};

/// Bounds of what lies on one side of the plane.
struct Side {
    Narrow lo[3], hi[3];

    HWY_INLINE Side() {
        for (std::size_t i = 0; i < 3; ++i) {
            lo[i] = hn::Set(NarrowTag(), INFINITY);
            hi[i] = hn::Set(NarrowTag(), -INFINITY);
        }
    }
    HWY_INLINE void extend(std::size_t i, NarrowMask where, Narrow from, Narrow to) {
        const NarrowTag d;
        lo[i] = hn::Min(lo[i], hn::IfThenElse(where, from, hn::Set(d, INFINITY)));
        hi[i] = hn::Max(hi[i], hn::IfThenElse(where, to, hn::Set(d, -INFINITY)));
    }
    HWY_INLINE void extend(NarrowMask where, const NarrowPoint& p) {
        for (std::size_t i = 0; i < 3; ++i) extend(i, where, p.at[i], p.at[i]);
    }
    HWY_INLINE void intersect(std::size_t i, Narrow from, Narrow to) {
        lo[i] = hn::Max(lo[i], from);
        hi[i] = hn::Min(hi[i], to);
    }
};

HWY_INLINE Narrow next_up(Narrow x) {
    const NarrowTag d;
    const hn::RebindToSigned<NarrowTag> di;
    const auto bits = hn::BitCast(di, hn::Add(x, hn::Zero(d)));
    // 1 or -1, by the sign.
    const auto step = hn::Or(hn::ShiftRight<31>(bits), hn::Set(di, 1));
    return hn::BitCast(d, hn::Add(bits, step));
}

/// x rounded to a float that is not below it.
HWY_INLINE Narrow round_up(Doubles x) {
    const DoubleTag dd;
    const NarrowTag d;
    const Narrow nearest = hn::DemoteTo(d, x);
    const Doubles exact = hn::PromoteTo(dd, nearest);
    return hn::DemoteTo(d, hn::IfThenElse(hn::Lt(exact, x), hn::PromoteTo(dd, next_up(nearest)), exact));
}

/// Where an edge crosses the plane, which then belongs to both sides.
HWY_INLINE void add_crossing(const NarrowPoint& a, const NarrowPoint& b, Narrow plane, Side& below, Side& above) {
    const DoubleTag dd;
    const NarrowMask rises = hn::Lt(a.at[0], b.at[0]);
    // From the lower end always, so that triangles which share the edge agree.
    const auto from = [&](std::size_t i)
                          HWY_ATTR { return hn::PromoteTo(dd, hn::IfThenElse(rises, a.at[i], b.at[i])); };
    const auto to = [&](std::size_t i) HWY_ATTR { return hn::PromoteTo(dd, hn::IfThenElse(rises, b.at[i], a.at[i])); };
    const NarrowMask crosses =
        hn::And(hn::Lt(hn::Min(a.at[0], b.at[0]), plane), hn::Gt(hn::Max(a.at[0], b.at[0]), plane));
    const Doubles share = hn::Div(hn::Sub(hn::PromoteTo(dd, plane), from(0)), hn::Sub(to(0), from(0)));
    below.extend(0, crosses, plane, plane);
    above.extend(0, crosses, plane, plane);
    for (std::size_t i = 1; i < 3; ++i) {
        const Doubles point = hn::Add(from(i), hn::Mul(share, hn::Sub(to(i), from(i))));
        const Narrow lo = hn::Neg(round_up(hn::Neg(point))), hi = round_up(point);
        below.extend(i, crosses, lo, hi);
        above.extend(i, crosses, lo, hi);
    }
}

HWY_INLINE void split_block(const CutBlock& block, float at, Side& below, Side& above) {
    const NarrowTag d;
    const Narrow plane = hn::Set(d, at);
    const NarrowPoint corners[3] = {block.corner(0), block.corner(1), block.corner(2)};
    for (std::size_t v = 0; v < 3; ++v) {
        below.extend(hn::Le(corners[v].at[0], plane), corners[v]);
        above.extend(hn::Ge(corners[v].at[0], plane), corners[v]);
        add_crossing(corners[v], corners[(v + 1) % 3], plane, below, above);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const Narrow lo = hn::Load(d, block.lo[i]), hi = hn::Load(d, block.hi[i]);
        below.intersect(i, lo, i == 0 ? plane : hi);
        above.intersect(i, i == 0 ? plane : lo, hi);
    }
}

/// Stored, to be read one after another.
struct SideRows {
    alignas(64) NarrowRow lo[3], hi[3];
    LaneBits reached;  ///< That are not empty.

    HWY_INLINE explicit SideRows(const Side& side) {
        const NarrowTag d;
        for (std::size_t i = 0; i < 3; ++i) {
            hn::Store(side.lo[i], d, lo[i]);
            hn::Store(side.hi[i], d, hi[i]);
        }
        const auto in_order = [&](std::size_t i) HWY_ATTR { return hn::Le(side.lo[i], side.hi[i]); };
        reached = bits_of(d, hn::And(in_order(0), hn::And(in_order(1), in_order(2))));
    }
    HWY_INLINE void write(std::size_t k, const Axes& axes, Bounds3& box) const {
        for (std::size_t i = 0; i < 3; ++i) {
            (&box.lo.x)[axes.at[i]] = lo[i][k];
            (&box.hi.x)[axes.at[i]] = hi[i][k];
        }
    }
    HWY_INLINE std::uint32_t reaches(std::size_t k) const { return reached >> k & 1; }
};

HWY_ATTR KdPartCounts split_all(std::span<const KdReference> references, const TriangleMesh& mesh, int axis,
                                float plane, KdReference* below, KdReference* above) {
    const Axes axes(static_cast<std::size_t>(axis));
    KdPartCounts parts;
    // So that they come from memory together.
    constexpr std::size_t kFetched = 64;
    for (std::size_t first = 0; first < references.size(); first += kAtOnce) {
        for (std::size_t k = first; first % kFetched == 0 && k < std::min(first + kFetched, references.size()); ++k)
            hwy::Prefetch(&mesh.triangles[references[k].primitive]);
        const std::size_t n = std::min(kAtOnce, references.size() - first);
        CutBlock block;
        std::uint32_t primitive[kAtOnce];
        std::uint32_t owned[kAtOnce];
        for (std::size_t k = 0; k < n; ++k) {
            const KdReference& reference = references[first + k];
            block.put(k, reference, mesh, axes);
            primitive[k] = reference.primitive;
            owned[k] = reference.owned;
        }
        Side side_below, side_above;
        split_block(block, plane, side_below, side_above);
        const SideRows rows_below(side_below), rows_above(side_above);
        for (std::size_t k = 0; k < n; ++k) {
            KdReference &to_below = below[parts.below], &to_above = above[parts.above];
            rows_below.write(k, axes, to_below.box);
            to_below.primitive = primitive[k];
            to_below.owned = owned[k];
            rows_above.write(k, axes, to_above.box);
            to_above.primitive = primitive[k];
            to_above.owned = owned[k] & (1 - rows_below.reaches(k));
            // What reaches no farther is written over.
            parts.below += rows_below.reaches(k);
            parts.above += rows_above.reaches(k);
        }
    }
    return parts;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(split_all);

KdPartCounts split_references(std::span<const KdReference> references, const TriangleMesh& mesh, int axis, float plane,
                              KdReference* below, KdReference* above) {
    return HWY_DYNAMIC_DISPATCH(split_all)(references, mesh, axis, plane, below, above);
}

}  // namespace rayuela
#endif
