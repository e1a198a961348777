// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_KD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_KD_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_KD_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_KD_LANES_INL_H_
#endif

#include "core/accel/kd_tree.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <span>

#include "core/accel/lane_types-inl.h"
#include "core/accel/ray_block-inl.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A value for each axis and lane.
using LaneAxes = float[3][kLanes];

struct AxisChoice {
    FloatMask x, z;

    HWY_INLINE explicit AxisChoice(Words axis) {
        const WordTag dw;
        x = hn::RebindMask(FloatTag(), hn::Eq(axis, hn::Zero(dw)));
        z = hn::RebindMask(FloatTag(), hn::Eq(axis, hn::Set(dw, 2)));
    }
    HWY_INLINE Floats of(const LaneAxes& values) const {
        const FloatTag d;
        return hn::IfThenElse(x, hn::Load(d, values[0]),
                              hn::IfThenElse(z, hn::Load(d, values[2]), hn::Load(d, values[1])));
    }
};

/// A node still to be visited, and where the ray is in it.
struct alignas(16) WayEntry {
    float begin, end;
    float node;  ///< Its index, by its bits.
    float unused;
};

/// As many nodes a ray may have to visit when it is put into a lane.
inline constexpr std::size_t kMaxRest = 16;

/// One ray a lane, each with its own node and stack. A step takes every lane that stands at an inner node one node on; lanes
/// at a leaf stand still. Planes are passed RayBlock::pad early and late, so that the children overlap.
class LaneGroup {
public:
    /// Lanes without a ray write to stacks of their own like all others.
    LaneGroup() { hn::Store(hn::Iota(WordTag(), 0), WordTag(), height_); }

    /// Puts a ray at the root.
    HWY_INLINE void start(std::size_t lane, const RayBlock& block, std::size_t i) {
        set_ray(lane, block, i);
        begin_[lane] = block.begin[i];
        end_[lane] = block.end[i];
        node_[lane] = 0;
        height_[lane] = static_cast<std::uint32_t>(lane);
    }
    /// Puts a ray at the first of the nodes that it has still to visit.
    HWY_INLINE void start(std::size_t lane, const RayBlock& block, std::size_t i, std::span<const WayEntry> rest) {
        set_ray(lane, block, i);
        begin_[lane] = rest[0].begin;
        end_[lane] = rest[0].end;
        node_[lane] = std::bit_cast<std::uint32_t>(rest[0].node);
        std::size_t height = lane;
        for (std::size_t k = rest.size() - 1; k > 0; --k, height += kLanes) stack_[height] = rest[k];
        height_[lane] = static_cast<std::uint32_t>(height);
    }
    LaneBits active() const { return active_; }
    /// What begins behind `t` no longer counts for the lane's ray.
    void set_limit(std::size_t lane, float t) { limit_[lane] = t; }
    /// The lane's ray has its answer.
    void stop(std::size_t lane) { active_ &= ~(LaneBits{1} << lane); }

    /// Number of lanes that moved.
    HWY_INLINE std::size_t step(const KdNode* nodes) {
        const FloatTag d;
        const WordTag dw;
        const Words node = hn::Load(dw, node_);
        const WordPairs pair = gather_pairs(reinterpret_cast<const std::uint64_t*>(nodes), node_);
        const Floats plane = hn::BitCast(d, pair.low);
        const Words axis = hn::And(pair.high, hn::Set(dw, KdNode::kAxisMask));
        const AxisChoice choice(axis);
        const auto is_inner = hn::Ne(axis, hn::Set(dw, KdNode::kLeaf));
        const FloatMask inner = hn::RebindMask(d, is_inner);
        const Floats inverse = choice.of(inverse_), distance = hn::Sub(plane, choice.of(origin_));
        const Floats pad = hn::Mul(hn::Load(d, pad_), hn::Abs(inverse));
        const Floats enter = hn::MulSub(distance, inverse, pad), leave = hn::MulAdd(distance, inverse, pad);
        const Floats begin = hn::Load(d, begin_), end = hn::Load(d, end_);

        const Words backward = hn::ShiftRight<31>(hn::BitCast(dw, inverse));
        const Words one = hn::Set(dw, 1);
        const Words empty = hn::ShiftRight<KdNode::kEmptyShift>(pair.high);
        const FloatMask far_empty = hn::RebindMask(d, hn::TestBit(hn::Shr(empty, hn::Xor(backward, one)), one));
        const FloatMask near_empty = hn::RebindMask(d, hn::TestBit(hn::Shr(empty, backward), one));
        // An empty leaf is entered only where the ray passes nothing else here. The way through the other child ends or
        // begins at the plane all the same: what it does not reach there is not visited.
        const FloatMask beyond = hn::Gt(enter, hn::Min(end, hn::Load(d, limit_))), before = hn::Lt(leave, begin);
        const FloatMask only_far = hn::AndNot(beyond, hn::Or(before, near_empty));
        const FloatMask to_far = hn::And(only_far, inner), to_near = hn::AndNot(only_far, inner);
        const FloatMask both = hn::AndNot(hn::Or(beyond, far_empty), to_near);
        const Floats far_begin = hn::Max(enter, begin);
        hn::Store(pair.low, dw, word_);
        hn::Store(pair.high, dw, data_);
        const Words children = hn::ShiftRight<KdNode::kChildrenShift>(pair.high);
        const Words near = hn::Add(children, backward);
        const Words far = hn::Add(children, hn::Xor(backward, one));

        const Words height = hn::Load(dw, height_);
        // What is written for the other lanes lies above the top of their stacks.
        store_fours(far_begin, end, hn::BitCast(d, far), end,
                    [&](std::size_t lane) HWY_ATTR { return &stack_[height_[lane]].begin; });
        const auto pushed = hn::RebindMask(dw, both);
        hn::Store(hn::Add(height, hn::IfThenElseZero(pushed, hn::Set(dw, kLanes))), dw, height_);
        const Words next = hn::IfThenElse(hn::RebindMask(dw, to_far), far, near);
        hn::Store(hn::IfThenElse(is_inner, next, node), dw, node_);
        hn::Store(hn::IfThenElse(to_far, far_begin, begin), d, begin_);
        hn::Store(hn::IfThenElse(to_near, hn::Min(leave, end), end), d, end_);
        return hn::CountTrue(dw, is_inner);
    }

    /// Fetches the nodes of the next step.
    HWY_INLINE void prefetch(const KdNode* nodes) const {
        for (std::size_t lane = 0; lane < kLanes; ++lane) hwy::Prefetch(nodes + node_[lane]);
    }

    /// The lanes that stood at a leaf when the last step was taken, and those of them whose leaf holds something.
    struct AtLeaf {
        LaneBits any, filled;
    };
    HWY_INLINE AtLeaf at_leaf() const {
        const WordTag dw;
        const Words data = hn::Load(dw, data_), leaf = hn::Set(dw, KdNode::kLeaf);
        const LaneBits any = active_ & bits_of(dw, hn::Eq(hn::And(data, hn::Set(dw, KdNode::kAxisMask)), leaf));
        return {any, any & bits_of(dw, hn::Ne(data, leaf))};
    }
    /// Of the leaf that the lane stands at.
    std::uint32_t first(std::size_t lane) const { return word_[lane]; }
    std::uint32_t count(std::size_t lane) const { return data_[lane] >> KdNode::kCountShift; }

    /// Takes the lanes to the next nodes on their stacks that begin before their limits. Those that have none stop.
    HWY_INLINE void pop(LaneBits lanes) {
        const FloatTag d;
        const WordTag dw;
        const Words bottom = hn::Iota(dw, 0);
        if (lanes == 0) return;
        FloatMask todo = mask_of(lanes);
        Words node = hn::Load(dw, node_), height = hn::Load(dw, height_);
        Floats begin = hn::Load(d, begin_), end = hn::Load(d, end_);
        const Floats limit = hn::Load(d, limit_);
        while (true) {
            const FloatMask empty = hn::And(todo, hn::RebindMask(d, hn::Eq(height, bottom)));
            active_ &= ~bits_of(d, empty);
            todo = hn::AndNot(empty, todo);
            if (hn::AllFalse(d, todo)) break;
            const auto popped = hn::RebindMask(dw, todo);
            height = hn::IfThenElse(popped, hn::Sub(height, hn::Set(dw, kLanes)), height);
            hn::Store(height, dw, height_);
            const FourLanes entry = load_fours([&](std::size_t lane) HWY_ATTR { return &stack_[height_[lane]].begin; });
            begin = hn::IfThenElse(todo, entry.x, begin);
            end = hn::IfThenElse(todo, entry.y, end);
            node = hn::IfThenElse(popped, hn::BitCast(dw, entry.z), node);
            todo = hn::And(todo, hn::Gt(begin, limit));
        }
        hn::Store(node, dw, node_);
        hn::Store(begin, d, begin_);
        hn::Store(end, d, end_);
    }

private:
    HWY_INLINE void set_ray(std::size_t lane, const RayBlock& block, std::size_t i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            origin_[axis][lane] = block.origin[axis][i];
            inverse_[axis][lane] = block.inverse[axis][i];
        }
        pad_[lane] = block.pad[i];
        limit_[lane] = block.limit[i];
        active_ |= LaneBits{1} << lane;
    }

    alignas(64) LaneAxes origin_{}, inverse_{};
    alignas(64) float pad_[kLanes] = {};  ///< RayBlock::pad.
    alignas(64) float begin_[kLanes] = {}, end_[kLanes] = {}, limit_[kLanes] = {};
    alignas(64) std::uint32_t node_[kLanes] = {}, height_[kLanes] = {};
    alignas(64) std::uint32_t word_[kLanes] = {}, data_[kLanes] = {};  ///< Of the nodes at the last step.
    alignas(64) WayEntry stack_[(kMaxRest + kKdMaxDepth + 1) * kLanes];
    LaneBits active_ = 0;
};

/// A ray that has come to a leaf with primitives.
struct LeafVisit {
    std::uint32_t slot;
    std::uint32_t first, count;  ///< References of the leaf.
};

/// Many rays on their way through one tree.
struct LaneGroups {
    LaneGroup group[kGroups];

    /// Number of lanes that moved.
    HWY_INLINE std::size_t step(const KdTree& tree) {
        // With fewer, fetching takes longer than it saves.
        constexpr std::size_t kManyNodes = std::size_t{1} << 20;
        const KdNode* const nodes = tree.nodes.data();
        const bool many = tree.nodes.size() > kManyNodes;
        std::size_t moved = 0;
        for (LaneGroup& one : group) {
            moved += one.step(nodes);
            if (many) one.prefetch(nodes);
        }
        return moved;
    }
    LaneGroup& of(std::size_t slot) { return group[slot / kLanes]; }
    void set_limit(std::size_t slot, float t) { of(slot).set_limit(slot % kLanes, t); }
    void stop(std::size_t slot) { of(slot).stop(slot % kLanes); }
};

/// Rays of a block, each to start at the root of a tree.
template <typename Client>
class BlockRays {
public:
    BlockRays(const RayBlock& block, Client& client) : block_(block), client_(client) {}

    HWY_INLINE bool start(LaneGroup& group, std::size_t slot) {
        while (next_ < block_.size && !block_.is_open(next_)) ++next_;
        if (next_ == block_.size) return false;
        client_.start(slot, next_);
        group.start(slot % kLanes, block_, next_++);
        return true;
    }

private:
    const RayBlock& block_;
    Client& client_;
    std::size_t next_ = 0;
};

/// Traces rays through the tree, many at once:
/// `bool rays.start(group, slot)` gives the slot, in this group, the next ray; false where there is none;
/// `void client.visit(span<const LeafVisit>, slots)` tests the primitives of the leaves, then sets the limits of the slots or
/// stops those that have their answers.
template <typename Rays, typename Client>
HWY_INLINE void trace_rays(const KdTree& tree, Rays& rays, Client& client) {
    LaneGroups groups;
    const auto refill = [&](std::size_t g) HWY_ATTR {
        constexpr LaneBits kAll = static_cast<LaneBits>((std::uint64_t{1} << kLanes) - 1);
        for (LaneBits idle = kAll & ~groups.group[g].active(); idle != 0; idle &= idle - 1) {
            if (!rays.start(groups.group[g], g * kLanes + first_lane(idle))) return;
        }
    };
    while (true) {
        int active = 0;
        for (std::size_t g = 0; g < kGroups; ++g) {
            refill(g);
            active += std::popcount(groups.group[g].active());
        }
        if (active == 0) return;
        const std::size_t few = static_cast<std::size_t>(active) * 3 / 8;
        while (groups.step(tree) > few) {
        }

        LeafVisit visits[kSlots];
        std::size_t count = 0;
        LaneBits at_leaf[kGroups];
        for (std::size_t g = 0; g < kGroups; ++g) {
            const LaneGroup& group = groups.group[g];
            const LaneGroup::AtLeaf at = group.at_leaf();
            at_leaf[g] = at.any;
            for (LaneBits lanes = at.filled; lanes != 0; lanes &= lanes - 1) {
                const std::size_t lane = first_lane(lanes);
                const LeafVisit visit{static_cast<std::uint32_t>(g * kLanes + lane), group.first(lane),
                                      group.count(lane)};
                client.prefetch(visit);
                visits[count++] = visit;
            }
        }
        client.visit(std::span<const LeafVisit>(visits, count), groups);
        for (std::size_t g = 0; g < kGroups; ++g) groups.group[g].pop(at_leaf[g] & groups.group[g].active());
    }
}

/// The rays of the block from the root on. `void client.start(slot, i)`: ray i of the block now has the slot.
template <typename Client>
HWY_INLINE void trace_lanes(const KdTree& tree, const RayBlock& block, Client& client) {
    BlockRays<Client> rays(block, client);
    trace_rays(tree, rays, client);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
