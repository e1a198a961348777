// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_BEAMS_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_BEAMS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_BEAMS_INL_H_
#endif

#include "core/accel/beam_hits-inl.h"
#include "core/accel/object_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// An edge function of triangles over the rays of a beam: for the ray with the shears of the middle, and what it gains with the
/// shears. For vertices p, q as the middle sees them, a ray with shears larger by dx, dy sees p.xy - p.z (dx, dy), and likewise
/// q; in p.x q.y - p.y q.x the products of dx and dy cancel.
struct EdgePlane {
    Floats middle, by_x, by_y;

    HWY_INLINE static EdgePlane of(const ShearedVertices& p, const ShearedVertices& q) {
        return {hn::NegMulAdd(p.y, q.x, p.x * q.y), hn::NegMulAdd(p.z, q.y, p.y * q.z),
                hn::NegMulAdd(p.x, q.z, p.z * q.x)};
    }
    HWY_INLINE Floats at(Floats dx, Floats dy) const { return hn::MulAdd(dy, by_y, hn::MulAdd(dx, by_x, middle)); }
    /// By how much it changes at most where dx, dy change by these.
    HWY_INLINE Floats change(Floats x, Floats y) const { return hn::MulAdd(hn::Abs(by_x), x, hn::Abs(by_y) * y); }
};

/// Triangles before the rays of a beam.
struct BeamTriangles {
    EdgePlane u, v, w;
    Floats slack;              ///< By how much the edge functions may be off.
    Floats nearest, farthest;  ///< Depths.

    /// Whether one of rays may hit one of the triangles, in all lanes or one a lane.
    HWY_INLINE FloatMask may_hit(Floats dx, Floats dy, Floats begin, Floats end) const {
        const Floats at_u = u.at(dx, dy), at_v = v.at(dx, dy), at_w = w.at(dx, dy);
        const auto outside = hn::And(hn::Lt(hn::Min(at_u, hn::Min(at_v, at_w)), hn::Neg(slack)),
                                     hn::Gt(hn::Max(at_u, hn::Max(at_v, at_w)), slack));
        return hn::Not(hn::Or(outside, hn::Or(hn::Lt(farthest, begin), hn::Gt(nearest, end))));
    }
};

/// The same, to be taken one by one.
struct StoredTriangles {
    alignas(64) float value[12][kLanes];

    HWY_INLINE void set(const BeamTriangles& triangles) {
        const auto& [u, v, w, slack, nearest, farthest] = triangles;
        const Floats values[12] = {u.middle, u.by_x, u.by_y, v.middle, v.by_x,  v.by_y,
                                   w.middle, w.by_x, w.by_y, slack,    nearest, farthest};
        for (std::size_t k = 0; k < 12; ++k) hn::Store(values[k], FloatTag(), value[k]);
    }
    /// Triangle i in all lanes.
    HWY_INLINE BeamTriangles triangle(std::size_t i) const {
        const auto all = [&](std::size_t k) HWY_ATTR { return hn::Set(FloatTag(), value[k][i]); };
        return {{all(0), all(1), all(2)}, {all(3), all(4), all(5)}, {all(6), all(7), all(8)}, all(9), all(10), all(11)};
    }
};

/// The rays of a beam against the triangles of leaves. In float, with proven bounds: the rays of a part against one triangle, or
/// one ray against up to kLanes triangles, whichever is less work; then exactly for what is left.
class TriangleBeam {
public:
    TriangleBeam(const MeshTree& mesh, const Beam& beam, const RayBlock& block, BeamHits& hits)
        : mesh_(mesh), beam_(beam), hits_(hits) {
        const FloatTag d;
        float largest[2] = {0, 0};
        for (std::size_t p = 0; p < kParts; ++p) {
            if (beam.rays[p] == 0) continue;
            const std::size_t i = beam.first + p * kLanes;
            set_slopes(p, 0, block.shear_x + i, largest[0], parts_[p].dx, parts_[p].steep_x);
            set_slopes(p, 1, block.shear_y + i, largest[1], parts_[p].dy, parts_[p].steep_y);
            hn::Store(hn::Abs(hn::LoadU(d, block.depth + i)), d, parts_[p].depth);
            hn::Store(hn::LoadU(d, block.depth_pad + i), d, parts_[p].depth_pad);
            set_range(p);
        }
        spread_ = std::max(largest[0], largest[1]);
        set_limit();
    }

    /// Tests the triangles of the leaf with all rays.
    HWY_INLINE void test_all(const KdNode& leaf) {
        Visit visit{leaf, {}};
        std::copy_n(beam_.rays, kParts, visit.rays);
        test(visit);
    }

    /// Sends for the triangles of the leaf, if a ray goes through its cell, and tests those sent for before. The depth beyond which
    /// no ray looks for hits.
    HWY_INLINE float visit(const KdNode& leaf, const KdCell& cell, std::uint32_t parts) {
        Visit visit{leaf, {}};
        LaneBits any = 0;
        for (; parts != 0; parts &= parts - 1) {
            const std::size_t p = first_lane(parts);
            any |= visit.rays[p] = through(p, cell);
        }
        if (any == 0) return limit_;
        prefetch_leaf(mesh_, leaf.first(), leaf.count());
        if (waits_) test(waiting_);
        waiting_ = visit;
        waits_ = true;
        return limit_;
    }
    /// Those of the parts of which a ray may go through a cell between two depths: by the slopes of each part, in small cells by
    /// its rays, between which such cells may lie.
    HWY_INLINE std::uint32_t through(const KdCell& cell, float begin, float end, std::uint32_t parts) const {
        const std::uint32_t axes[2] = {beam_.turn.x, beam_.turn.y};
        const PartTag d;
        const auto first = hn::Set(d, begin), last = hn::Min(hn::Set(d, end), hn::Load(d, last_));
        auto passed_by = hn::Gt(first, last);
        for (std::size_t k = 0; k < 2; ++k) {
            const float lo = cell.lo(axes[k]), hi = cell.hi(axes[k]);
            if (hi - lo < kSmall * begin * largest_part_[k]) return some_through(cell, parts);
            const float origin = beam_.origin[axes[k]], pad = 2 * beam_.pad;
            const auto slope_lo = hn::Load(d, slope_lo_[k]), slope_hi = hn::Load(d, slope_hi_[k]);
            const auto below = hn::Lt(hn::Max(slope_hi * first, slope_hi * last), hn::Set(d, lo - pad - origin));
            const auto above = hn::Gt(hn::Min(slope_lo * first, slope_lo * last), hn::Set(d, hi + pad - origin));
            passed_by = hn::Or(passed_by, hn::Or(below, above));
        }
        return parts & ~static_cast<std::uint32_t>(bits_of(d, passed_by));
    }
    HWY_INLINE void finish() {
        if (waits_) test(waiting_);
        hits_.decide_added();
    }

private:
    static constexpr std::size_t kParts = Beam::kParts;

    using PartTag = hn::CappedTag<float, 8>;
    static constexpr std::size_t kPartRoom = 8;
    static_assert(kParts <= kPartRoom);

    struct Part {
        alignas(64) float dx[kLanes], dy[kLanes];            ///< Shears beyond those of the middle.
        alignas(64) float steep_x[kLanes], steep_y[kLanes];  ///< Depth along a way of 1 across.
        alignas(64) float begin[kLanes], end[kLanes];        ///< Depths between which hits count.
        alignas(64) float depth[kLanes], depth_pad[kLanes];  ///< As RayBlock has them, positive.
        Beam::Range x, y;                                    ///< Of dx, dy.
    };
    struct Visit {
        KdNode leaf;
        LaneBits rays[kParts];
    };

    HWY_INLINE void set_slopes(std::size_t p, std::size_t axis, const double* shears, float& largest,
                               float* differences, float* steep) {
        const FloatTag d;
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        const auto middle = hn::Set(dd, double{beam_.shear[axis].middle()});
        for (std::size_t lane = 0; lane < kLanes; lane += kDoubles)
            hn::Store(hn::DemoteTo(df, hn::LoadU(dd, shears + lane) - middle), df, differences + lane);
        const Floats slope = demoted(shears) * hn::Set(d, beam_.sign);
        const Floats size = hn::Max(hn::Abs(slope), hn::Set(d, 1 / BeamWay::kSteep));
        hn::Store(hn::Set(d, 1) / hn::CopySignToAbs(size, slope), d, steep);
        const FloatMask open = mask_of(beam_.rays[p]);
        const Floats difference = hn::Load(d, differences), far = hn::Set(d, kInfinity);
        Beam::Range& range = axis == 0 ? parts_[p].x : parts_[p].y;
        range.lo = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(open, difference, far)));
        range.hi = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(open, difference, hn::Neg(far))));
        largest = std::max(largest, std::max(std::fabs(range.lo), std::fabs(range.hi)));
        slope_lo_[axis][p] = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(open, slope, far)));
        slope_hi_[axis][p] = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(open, slope, hn::Neg(far))));
        largest_part_[axis] = std::max(largest_part_[axis], slope_hi_[axis][p] - slope_lo_[axis][p]);
    }

    HWY_INLINE void set_range(std::size_t p) {
        const FloatTag d;
        Part& part = parts_[p];
        const DepthRange range =
            depth_range(hn::Load(d, part.depth), hn::Load(d, part.depth_pad), hits_.begin(p), hits_.end(p));
        const FloatMask open = mask_of(beam_.rays[p]);
        const Floats end = hn::IfThenElse(open, range.end, hn::Set(d, -kInfinity));
        hn::Store(hn::IfThenElse(open, range.begin, hn::Set(d, kInfinity)), d, part.begin);
        hn::Store(end, d, part.end);
        last_[p] = hn::GetLane(hn::MaxOfLanes(d, end));
    }
    HWY_INLINE void set_limit() {
        limit_ = -1;
        for (std::size_t p = 0; p < kParts; ++p) limit_ = beam_.rays[p] != 0 ? std::max(limit_, last_[p]) : limit_;
    }

    /// The parts of which a ray goes through a cell before its hit.
    HWY_INLINE std::uint32_t some_through(const KdCell& cell, std::uint32_t parts) const {
        std::uint32_t left = 0;
        for (; parts != 0; parts &= parts - 1) {
            const std::size_t p = first_lane(parts);
            left |= (through(p, cell) != 0 ? 1u : 0u) << p;
        }
        return left;
    }
    /// The rays of a part that go through a cell before their hits.
    HWY_INLINE LaneBits through(std::size_t p, const KdCell& cell) const {
        const FloatTag d;
        if (beam_.rays[p] == 0) return 0;
        const Part& part = parts_[p];
        const float pad = 2 * beam_.pad;
        const auto lo = [&](std::uint32_t axis) { return cell.lo(axis) - pad - beam_.origin[axis]; };
        const auto hi = [&](std::uint32_t axis) { return cell.hi(axis) + pad - beam_.origin[axis]; };
        const Turn& turn = beam_.turn;
        const Floats steep_x = hn::Load(d, part.steep_x), steep_y = hn::Load(d, part.steep_y);
        const Floats x0 = hn::Set(d, lo(turn.x)) * steep_x, x1 = hn::Set(d, hi(turn.x)) * steep_x;
        const Floats y0 = hn::Set(d, lo(turn.y)) * steep_y, y1 = hn::Set(d, hi(turn.y)) * steep_y;
        const bool up = beam_.sign > 0;
        const Floats z0 = hn::Set(d, up ? lo(turn.z) : -hi(turn.z)), z1 = hn::Set(d, up ? hi(turn.z) : -lo(turn.z));
        const Floats enter = hn::Max(hn::Max(hn::Min(x0, x1), hn::Min(y0, y1)), hn::Max(z0, hn::Load(d, part.begin)));
        const Floats leave = hn::Min(hn::Min(hn::Max(x0, x1), hn::Max(y0, y1)), hn::Min(z1, hn::Load(d, part.end)));
        return bits_of(d, hn::Le(enter, leave));
    }

    HWY_INLINE void test(const Visit& visit) {
        each_block(mesh_, visit.leaf.first(), visit.leaf.count(), [&](const LeafBlock& block) HWY_ATTR {
            for (std::size_t i = 0; i < block.triangles(); i += kLanes) test(block, i, visit);
        });
        hits_.decide_added();
        bool any = false;
        for (std::size_t p = 0; p < kParts; ++p) {
            if (hits_.take_closer(p) == 0) continue;
            set_range(p);
            any = true;
        }
        if (any) set_limit();
    }

    /// Triangles from `first` of a block. See may_hit: its bound, and what is rounded off by going over the middle. If x and y of
    /// hit triangles' vertices are below W as the middle sees them, and the rays' shears within S of its own with S z <= W, that is
    /// at most u W^2 by 4 for the value of the middle, 8 for each gain and 10 for their sums; as much again for the middles of parts.
    HWY_INLINE BeamTriangles before_beam(const LeafBlock& block, std::size_t first) const {
        const FloatTag d;
        const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
        const FilterSlack slack = FilterSlack::of(set(beam_.pad));
        const Turn& turn = beam_.turn;
        const FilterRays middle{set(beam_.origin[turn.x]),
                                set(beam_.origin[turn.y]),
                                set(beam_.origin[turn.z]),
                                set(beam_.shear[0].middle()),
                                set(beam_.shear[1].middle()),
                                slack,
                                set(0),
                                set(0)};
        const auto [a, b, c, extent] =
            block.vertices() > 0 ? shear_corners(middle, turn, block, first) : shear_runs(middle, turn, block, first);
        const Floats az = a.z * set(beam_.sign), bz = b.z * set(beam_.sign), cz = c.z * set(beam_.sign);
        const Floats nearest = hn::Min(az, hn::Min(bz, cz)), farthest = hn::Max(az, hn::Max(bz, cz));
        const Floats largest = hn::Max(hn::Abs(nearest), hn::Abs(farthest));
        const Floats size = hn::MulAdd(set(spread_), largest, extent + extent);
        const Floats rounding = set(64 * kUnitRoundoff) * size;
        return {EdgePlane::of(c, b),
                EdgePlane::of(a, c),
                EdgePlane::of(b, a),
                hn::MulAdd(rounding, size, hn::MulAdd(slack.slope, extent, slack.offset)),
                nearest,
                farthest};
    }

    HWY_INLINE void test(const LeafBlock& block, std::size_t first, const Visit& visit) {
        const FloatTag d;
        const BeamTriangles triangles = before_beam(block, first);
        const FloatMask there = hn::FirstN(d, block.triangles() - first);
        const CornerView view = CornerView::of(block);
        StoredTriangles stored;
        bool is_stored = false;
        for (std::size_t p = 0; p < kParts; ++p) {
            const Part& part = parts_[p];
            if (visit.rays[p] == 0) continue;
            if (static_cast<std::uint32_t>(std::popcount(visit.rays[p])) <= kFew) {
                for (LaneBits lanes = visit.rays[p]; lanes != 0; lanes &= lanes - 1) {
                    const std::size_t lane = first_lane(lanes);
                    const auto all = [&](const float* values) HWY_ATTR { return hn::Set(d, values[lane]); };
                    const FloatMask may = triangles.may_hit(all(part.dx), all(part.dy), all(part.begin), all(part.end));
                    for (LaneBits bits = bits_of(d, hn::And(may, there)); bits != 0; bits &= bits - 1) {
                        const std::size_t i = first + first_lane(bits);
                        hits_.add(p, lane, view, i, block.name(i));
                    }
                }
                continue;
            }
            LaneBits left = bits_of(d, hn::And(may_hit(triangles, p), there));
            if (left == 0) continue;
            if (!is_stored) stored.set(triangles);
            is_stored = true;
            const Floats dx = hn::Load(d, part.dx), dy = hn::Load(d, part.dy);
            const Floats begin = hn::Load(d, part.begin), end = hn::Load(d, part.end);
            for (; left != 0; left &= left - 1) {
                const std::size_t k = first_lane(left), i = first + k;
                const LaneBits candidates = bits_of(d, stored.triangle(k).may_hit(dx, dy, begin, end)) & visit.rays[p];
                if (candidates != 0) hits_.decide(p, candidates, view, i, block.name(i));
            }
        }
    }

    /// Whether any ray of a part may hit the triangles.
    HWY_INLINE FloatMask may_hit(const BeamTriangles& triangles, std::size_t p) const {
        const FloatTag d;
        const Part& part = parts_[p];
        const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
        const Floats x = set(part.x.middle()), y = set(part.y.middle());
        // Rounded up.
        constexpr float kHalf = 0.5f + 2 * kUnitRoundoff;
        const Floats half_x = set(kHalf * part.x.size()), half_y = set(kHalf * part.y.size());
        FloatMask below = hn::FirstN(d, 0), above = below;
        for (const EdgePlane& edge : {triangles.u, triangles.v, triangles.w}) {
            const Floats value = edge.at(x, y), margin = edge.change(half_x, half_y) + triangles.slack;
            below = hn::Or(below, hn::Lt(value, hn::Neg(margin)));
            above = hn::Or(above, hn::Gt(value, margin));
        }
        return hn::Not(hn::Or(hn::And(below, above), hn::Gt(triangles.nearest, set(last_[p]))));
    }

    /// So few rays of a part are tested one by one.
    static constexpr std::uint32_t kFew = 5;
    /// So many times the width of a part or narrower, a cell may lie between rays.
    static constexpr float kSmall = 4;

    const MeshTree& mesh_;
    const Beam& beam_;
    BeamHits& hits_;
    Part parts_[kParts];
    alignas(32) float slope_lo_[2][kPartRoom] = {}, slope_hi_[2][kPartRoom] =
                                                        {};  ///< Of the rays of each part, as depths grow.
    alignas(32) float last_[kPartRoom] = {};                 ///< Of the ends of each part's rays.
    float largest_part_[2] = {0, 0};                         ///< The widest range of slopes of a part.
    float spread_ = 0;                                       ///< How far shears are from those of the middle.
    float limit_ = -1;
    Visit waiting_;
    bool waits_ = false;
};

/// Traces the beams of the block through the mesh, and takes their rays out of the block.
HWY_INLINE void trace_beams(const MeshTree& mesh, std::uint32_t object, RayBlock& block, std::span<const Ray> rays,
                            std::span<Hit> hits) {
    Beam beam;
    for (std::size_t first = 0; first < block.size; first += Beam::kRays) {
        if (!beam.gather(block, first)) continue;
        BeamHits found(beam, object, block, rays, hits);
        TriangleBeam triangles(mesh, beam, block, found);
        BeamWay(beam).trace(mesh.tree, triangles);
        if (mesh.tree.apart != 0) triangles.test_all(mesh.tree.nodes[mesh.tree.apart]);
        triangles.finish();
        found.write(hits);
        for (std::size_t p = 0; p < Beam::kParts; ++p) {
            for (LaneBits lanes = beam.rays[p]; lanes != 0; lanes &= lanes - 1)
                block.close(first + p * kLanes + first_lane(lanes));
        }
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
