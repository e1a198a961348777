// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_KD_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_KD_BEAMS_INL_H_
#undef RAYUELA_CORE_ACCEL_KD_BEAMS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_KD_BEAMS_INL_H_
#endif

#include <bit>

#include "core/accel/kd_packets-inl.h"
#include "core/accel/triangle_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Neighbours of a block that leave one point along one dominant axis. Their way along it counts as depth, from the origin and
/// positive; across it they go by their slopes.
class Beam {
public:
    /// Parts are as many rays as there are lanes.
    static constexpr std::size_t kParts = kLanes < 16 ? 8 : 4, kRays = kParts * kLanes;
    /// A BeamWay needs so many lanes for a cell.
    static constexpr bool kSuits = kLanes >= 8;

    struct Range {
        float lo = kInfinity, hi = -kInfinity;

        float middle() const { return 0.5f * (lo + hi); }
        float size() const { return hi - lo; }
    };

    std::size_t first = 0;  ///< Ray of the block.
    LaneBits rays[kParts];  ///< Those that are open.
    Turn turn{2};
    float origin[3];          ///< RayBlock's.
    double turned_origin[3];  ///< RayBlock's.
    float pad = 0;            ///< RayBlock's.
    float sign = 1;           ///< Of the direction along the dominant axis.
    Range depth;              ///< Where rays may meet the tree.
    Range shear[2];           ///< RayBlock's, of all.

    /// Rays first to first + kRays of the block, if they are a beam.
    HWY_INLINE bool gather(const RayBlock& block, std::size_t from) {
        const FloatTag d;
        first = from;
        std::size_t count = 0, one = 0;
        for (std::size_t part = kParts; part-- > 0;) {
            const std::size_t i = first + part * kLanes;
            rays[part] = 0;
            if (i >= block.size) continue;
            const FloatMask open = hn::Le(hn::LoadU(d, block.begin + i), hn::LoadU(d, block.end + i));
            rays[part] = bits_of(d, hn::And(open, hn::FirstN(d, block.size - i)));
            count += static_cast<std::size_t>(std::popcount(rays[part]));
            if (rays[part] != 0) one = i + first_lane(rays[part]);
        }
        if (count < kRays / 2) return false;
        turn = Turn(block.dominant_axis[one]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            origin[axis] = block.origin[axis][one];
            turned_origin[axis] = block.turned_origin[axis][one];
        }
        pad = block.pad[one];
        sign = block.depth[one] < 0 ? -1.0f : 1.0f;
        return alike(block) && narrow();
    }

private:
    /// Whether all leave the same point along the same axis; takes the ranges from them.
    HWY_INLINE bool alike(const RayBlock& block) {
        const FloatTag d;
        const WordTag dw;
        const Floats far = hn::Set(d, kInfinity);
        Floats lo[2] = {far, far}, hi[2] = {hn::Neg(far), hn::Neg(far)}, begin = far, end = hn::Neg(far);
        for (std::size_t part = 0; part < kParts; ++part) {
            if (rays[part] == 0) continue;
            const std::size_t i = first + part * kLanes;
            const auto load = [&](const float* values) HWY_ATTR { return hn::LoadU(d, values + i); };
            const FloatMask open = mask_of(rays[part]);
            const Floats depth_of = load(block.depth) * hn::Set(d, sign);
            const FloatMask plain = hn::And(hn::Eq(load(block.t_scale), hn::Set(d, 1)), hn::Gt(depth_of, hn::Zero(d)));
            const auto axis = hn::Eq(hn::LoadU(dw, block.dominant_axis + i), hn::Set(dw, turn.z));
            const LaneBits same = bits_of(d, hn::And(plain, hn::RebindMask(d, axis))) & from_origin(block, i);
            if ((rays[part] & ~same) != 0) return false;
            const double* const shears[2] = {block.shear_x + i, block.shear_y + i};
            for (std::size_t k = 0; k < 2; ++k) {
                const Floats value = demoted(shears[k]);
                lo[k] = hn::Min(lo[k], hn::IfThenElse(open, value, far));
                hi[k] = hn::Max(hi[k], hn::IfThenElse(open, value, hn::Neg(far)));
            }
            begin = hn::Min(begin, hn::IfThenElse(open, load(block.begin) * depth_of, far));
            end = hn::Max(end, hn::IfThenElse(open, load(block.end) * depth_of, hn::Neg(far)));
        }
        for (std::size_t k = 0; k < 2; ++k)
            shear[k] = {hn::GetLane(hn::MinOfLanes(d, lo[k])), hn::GetLane(hn::MaxOfLanes(d, hi[k]))};
        constexpr float kRounding = 4 * kUnitRoundoff;
        depth = {hn::GetLane(hn::MinOfLanes(d, begin)), hn::GetLane(hn::MaxOfLanes(d, end))};
        depth.lo -= kRounding * std::fabs(depth.lo);
        depth.hi += kRounding * std::fabs(depth.hi);
        return true;
    }

    HWY_INLINE LaneBits from_origin(const RayBlock& block, std::size_t i) const {
        const DoubleTag dd;
        LaneBits same = 0;
        for (std::size_t lane = 0; lane < kLanes; lane += kDoubles) {
            const auto equal = [&](std::size_t axis) HWY_ATTR {
                return hn::Eq(hn::LoadU(dd, block.turned_origin[axis] + i + lane), hn::Set(dd, turned_origin[axis]));
            };
            same |= bits_of(dd, hn::And(equal(0), hn::And(equal(1), equal(2)))) << lane;
        }
        return same;
    }

    /// Whether slopes are alike, and numbers so common that none is rounded to 0 or to infinity; others go as packets.
    bool narrow() const {
        constexpr float kTurn = 1.0f / 8, kLeastPad = 0x1p-56f, kLargestPad = 0x1p40f;
        const bool alike = shear[0].size() <= kTurn && shear[1].size() <= kTurn;
        return alike && pad > kLeastPad && pad < kLargestPad && depth.lo >= 0;
    }
};

/// The cell of a node: its lower ends along x, y, z and a number without meaning, then its upper ends.
struct KdCell {
    alignas(32) float end[8];

    float lo(std::size_t axis) const { return end[axis]; }
    float hi(std::size_t axis) const { return end[4 + axis]; }
};

/// The way of a beam through a tree: of a node it is known which depths the beam has there, not which of its rays.
class BeamWay {
public:
    explicit BeamWay(const Beam& beam) : depth_(beam.depth), pad_(2 * beam.pad) {
        const std::uint32_t axes[3] = {beam.turn.x, beam.turn.y, beam.turn.z};
        for (std::size_t k = 0; k < 3; ++k) {
            const Beam::Range shear = k < 2 ? beam.shear[k] : Beam::Range{1, 1};
            const float a = beam.sign * shear.lo, b = beam.sign * shear.hi;
            const float up = std::max(a, b), down = -std::min(a, b);
            const bool both = up >= 0 && down >= 0;
            Side& side = sides_[axes[k]];
            side.origin = beam.origin[axes[k]];
            side.both = both ? ~0u : 0;
            side.above_first = !both && up < 0 ? 1 : 0;
            side.leave = both ? kSteep : inverse_slope(up < 0 ? -up : -down);
            side.enter[0] = inverse_slope(up > 0 || both ? up : down);
            side.enter[1] = inverse_slope(up < 0 || both ? down : up);
        }
    }

    /// Takes the beam through the tree, nearest leaves first:
    /// `std::uint32_t through(cell, begin, end, parts)`: those of the parts, a bit each, of which a ray may go through the cell
    /// between these depths;
    /// `float visit(leaf, cell, parts)` tests the leaf's primitives and returns the depth beyond which nothing counts.
    template <typename Client>
    HWY_INLINE void trace(const KdTree& tree, Client& client) {
        const CellTag d;
        const KdNode* const nodes = tree.nodes.data();
        const Bounds3& bounds = tree.bounds;
        KdCell corners{{bounds.lo.x, bounds.lo.y, bounds.lo.z, 0, bounds.hi.x, bounds.hi.y, bounds.hi.z, 0}};
        auto cell = hn::Load(d, corners.end);
        float begin = depth_.lo, end = depth_.hi, limit = kInfinity;
        std::uint32_t at = 0, parts = (1u << Beam::kParts) - 1;
        std::size_t height = 0;
        bool is_far = false;
        while (true) {
            const KdNode node = nodes[at];
            if (node.is_leaf()) {
                hn::Store(cell, d, corners.end);
                if (node.count() > 0) limit = client.visit(node, corners, parts);
            } else {
                // The near child's rays are mostly those of its parent.
                if (is_far) {
                    hn::Store(cell, d, corners.end);
                    parts = client.through(corners, begin, end, parts);
                }
                const Branch branch = split(node, begin, end);
                const std::uint32_t far = node.children() + 1 - branch.near;
                if (parts != 0 && branch.to_near) {
                    if (branch.to_far) {
                        Entry& entry = stack_[height++];
                        hn::Store(cut(cell, node, 1 - branch.near), d, entry.cell.end);
                        entry.node = far;
                        entry.parts = parts;
                        entry.begin = branch.far_begin;
                        entry.end = end;
                        hwy::Prefetch(nodes + nodes[far].children());
                    }
                    at = node.children() + branch.near;
                    cell = cut(cell, node, branch.near);
                    end = branch.near_end;
                    is_far = false;
                    continue;
                }
                if (parts != 0 && branch.to_far) {
                    at = far;
                    cell = cut(cell, node, 1 - branch.near);
                    begin = branch.far_begin;
                    is_far = true;
                    continue;
                }
            }
            do {
                if (height == 0) return;
                const Entry& entry = stack_[--height];
                at = entry.node;
                parts = entry.parts;
                begin = entry.begin;
                end = entry.end;
                cell = hn::Load(d, entry.cell.end);
            } while (begin > limit);
            is_far = true;
        }
    }

    /// What stands in for the inverse of a slope of 0.
    static constexpr float kSteep = 0x1p80f;

private:
    using CellTag = hn::CappedTag<float, 8>;

    /// The child that rays come to first, whether any come to it and to the other, and where.
    struct Branch {
        std::uint32_t near;
        bool to_near, to_far;
        float near_end, far_begin;
    };
    /// Along an axis: of a plane ahead at a distance, the slowest ray has left what is before it at the depth distance * leave,
    /// the fastest enters what is behind it at distance * enter.
    struct Side {
        float origin;
        std::uint32_t both;         ///< All bits where some go up and some down: each stays on its side.
        std::uint32_t above_first;  ///< 1 where all go down.
        float leave;
        float enter[2];  ///< Going up, going down.
    };
    /// A child still to be visited.
    struct Entry {
        KdCell cell;
        std::uint32_t node, parts;
        float begin, end;
    };

    static float inverse_slope(float slope) { return 1 / std::max(slope, 1 / kSteep); }

    HWY_INLINE Branch split(const KdNode& node, float begin, float end) const {
        const Side& side = sides_[node.axis()];
        const float difference = node.split() - side.origin;
        const std::uint32_t below_zero = std::bit_cast<std::uint32_t>(difference) >> 31;
        const std::uint32_t near = (below_zero & side.both) | side.above_first;
        const float distance = near != 0 ? -difference : difference;
        const float near_end = std::min(end, (distance + pad_) * side.leave);
        const float far_begin = std::max(begin, (distance - pad_) * side.enter[near]);
        return {near, begin <= near_end && !node.is_empty(near), far_begin <= end && !node.is_empty(1 - near), near_end,
                far_begin};
    }
    /// The part of a node's cell that is the child's, below the plane (0) or above (1).
    static HWY_INLINE hn::Vec<CellTag> cut(hn::Vec<CellTag> cell, const KdNode& node, std::uint32_t child) {
        const CellTag d;
        const auto moved = static_cast<float>(node.axis() + (child == 0 ? 4 : 0));
        return hn::IfThenElse(hn::Eq(hn::Iota(d, 0), hn::Set(d, moved)), hn::Set(d, node.split()), cell);
    }

    Beam::Range depth_;
    float pad_;
    Side sides_[3];
    Entry stack_[kKdMaxDepth + 1];
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
