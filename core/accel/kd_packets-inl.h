// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_KD_PACKETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_KD_PACKETS_INL_H_
#undef RAYUELA_CORE_ACCEL_KD_PACKETS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_KD_PACKETS_INL_H_
#endif

#include "core/accel/kd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// From the lowest to the highest of those `there`.
HWY_INLINE float spread(Floats values, FloatMask there) {
    const FloatTag d;
    const Floats lowest = hn::MinOfLanes(d, hn::IfThenElse(there, values, hn::Set(d, kInfinity)));
    const Floats highest = hn::MaxOfLanes(d, hn::IfThenElse(there, values, hn::Set(d, -kInfinity)));
    return hn::GetLane(highest) - hn::GetLane(lowest);
}

/// Rays of a block that stand side by side and go through a tree together, one node after the other, as long as it lies on
/// the way of one of them. Worth it for rays that stay together: from the camera, and from there to a lamp.
class Packet {
public:
    /// Of rays first to first + kLanes of the block, those of them that there are.
    HWY_INLINE Packet(const RayBlock& block, std::size_t first) : block_(block), first_(first) {
        const FloatTag d;
        hn::Store(hn::LoadU(d, block.limit + first), d, limit_);
        const Floats begin = load(block.begin), end = load(block.end);
        active_ = bits_of(d, hn::And(hn::FirstN(d, block.size - first), hn::Le(begin, end)));
        if (active_ == 0) return;
        const Words axes = hn::LoadU(WordTag(), block.dominant_axis + first);
        const auto same = hn::Eq(axes, hn::Set(WordTag(), block.dominant_axis[first + first_lane(active_)]));
        same_dominant_axis_ = (bits_of(WordTag(), same) & active_) == active_;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const LaneBits backward = bits_of(d, hn::Lt(load(block.inverse[axis]), hn::Zero(d))) & active_;
            backward_first_[axis] = 2 * std::popcount(backward) > std::popcount(active_);
            in_common_order_[axis] = backward_first_[axis] ? backward : ~backward;
        }
    }

    LaneBits active() const { return active_; }

    /// Whether the rays are like each other: the same dominant axis, origins not far apart in the tree, slopes alike.
    HWY_INLINE bool coherent(const Bounds3& bounds) const {
        constexpr float kSpread = 1.0f / 8;
        if (!same_dominant_axis_ || std::popcount(active_) < static_cast<int>(kLanes / 2)) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto component = static_cast<Vec3::length_type>(axis);
            if (!(spread(load(block_.origin[axis])) <= kSpread * (bounds.hi[component] - bounds.lo[component])))
                return false;
        }
        constexpr float kTurn = 1.0f / 2;
        return spread(load(block_.shear_x)) <= kTurn && spread(load(block_.shear_y)) <= kTurn;
    }

    /// What begins behind `t` no longer counts for the lane's ray.
    void set_limit(std::size_t lane, float t) { limit_[lane] = t; }
    /// The lane's ray has its answer.
    void stop(std::size_t lane) { active_ &= ~(LaneBits{1} << lane); }

    /// Takes the rays through the tree:
    /// `void start_packet(first, lanes)`: these are the rays, and those of them in `lanes` count;
    /// `void visit_packet(leaf, lanes, Packet&)` tests the leaf's primitives with the rays in `lanes`, then sets their limits
    /// or stops those that have their answers.
    template <typename Client>
    HWY_INLINE void trace(const KdTree& tree, Client& client) {
        const FloatTag d;
        const KdNode* const nodes = tree.nodes.data();
        client.start_packet(first_, active_);
        const Floats pad = load(block_.pad);
        Floats begin = load(block_.begin), end = load(block_.end), limit = hn::Load(d, limit_);
        FloatMask here = hn::And(mask_of(active_), hn::Le(begin, hn::Min(end, limit)));
        if (hn::AllFalse(d, here)) return;
        std::uint32_t at = 0;
        std::size_t height = 0;
        while (true) {
            const KdNode node = nodes[at];
            if (!node.is_leaf()) {
                const auto axis = static_cast<std::size_t>(node.axis());
                const Floats inverse = load(block_.inverse[axis]);
                const Floats middle = (hn::Set(d, node.split()) - load(block_.origin[axis])) * inverse;
                const Floats overlap = pad * hn::Abs(inverse), enter = middle - overlap, leave = middle + overlap;
                // Comparisons, because they leave begin and end alone where infinite bounds made a NaN.
                const FloatMask beyond = hn::Gt(enter, hn::Min(end, limit)), before = hn::Lt(leave, begin);
                const FloatMask to_far = hn::AndNot(beyond, here);
                const FloatMask to_near = hn::AndNot(hn::AndNot(beyond, before), here);
                const Floats near_end = hn::IfThenElse(hn::Lt(leave, end), leave, end);
                const Floats far_begin = hn::IfThenElse(hn::Gt(enter, begin), enter, begin);
                // The child that most rays meet first comes first; for the others it is the far one.
                const std::uint32_t first = backward_first_[axis] ? 1 : 0, second = 1 - first;
                const FloatMask common = mask_of(in_common_order_[axis]);
                const FloatMask to_first = hn::Or(hn::And(common, to_near), hn::AndNot(common, to_far));
                const FloatMask to_second = hn::Or(hn::And(common, to_far), hn::AndNot(common, to_near));
                const bool goes_first = !node.is_empty(first) && !hn::AllFalse(d, to_first);
                const bool goes_second = !node.is_empty(second) && !hn::AllFalse(d, to_second);
                const Floats second_begin = hn::IfThenElse(common, far_begin, begin),
                             second_end = hn::IfThenElse(common, end, near_end);
                if (goes_first) {
                    if (goes_second) {
                        Entry& entry = stack_[height++];
                        entry.node = node.children() + second;
                        hn::Store(hn::IfThenElse(to_second, second_begin, hn::Set(d, kInfinity)), d, entry.begin);
                        hn::Store(second_end, d, entry.end);
                    }
                    at = node.children() + first;
                    here = to_first;
                    begin = hn::IfThenElse(common, begin, far_begin);
                    end = hn::IfThenElse(common, near_end, end);
                    continue;
                }
                if (goes_second) {
                    at = node.children() + second;
                    here = to_second;
                    begin = second_begin;
                    end = second_end;
                    continue;
                }
            } else if (node.count() > 0) {
                client.visit_packet(node, bits_of(d, here), *this);
                if (active_ == 0) return;
                limit = hn::Load(d, limit_);
            }
            do {
                if (height == 0) return;
                const Entry& entry = stack_[--height];
                at = entry.node;
                begin = hn::Load(d, entry.begin);
                end = hn::Load(d, entry.end);
                here = hn::And(mask_of(active_), hn::Le(begin, hn::Min(end, limit)));
            } while (hn::AllFalse(d, here));
        }
    }

private:
    struct Entry {
        alignas(64) float begin[kLanes];  ///< Infinite for rays that do not come this way.
        alignas(64) float end[kLanes];
        std::uint32_t node;
    };

    HWY_INLINE Floats load(const float* of_block) const { return hn::LoadU(FloatTag(), of_block + first_); }
    HWY_INLINE Floats load(const double* of_block) const { return demoted(of_block + first_); }
    HWY_INLINE float spread(Floats values) const { return HWY_NAMESPACE::spread(values, mask_of(active_)); }

    const RayBlock& block_;
    std::size_t first_;
    LaneBits active_ = 0;
    bool same_dominant_axis_ = false;
    bool backward_first_[3] = {};  ///< Whether most rays meet the child above a plane first,
    LaneBits in_common_order_[3];  ///< and which are the most.
    alignas(64) float limit_[kLanes];
    Entry stack_[kKdMaxDepth + 1];
};

/// Traces what rays of the block go together through the tree, and takes them out of the block.
template <typename Client>
HWY_INLINE void trace_packets(const KdTree& tree, RayBlock& block, Client& client) {
    for (std::size_t first = 0; first < block.size; first += kLanes) {
        Packet packet(block, first);
        if (!packet.coherent(tree.bounds)) continue;
        const LaneBits rays = packet.active();
        packet.trace(tree, client);
        for (LaneBits lanes = rays; lanes != 0; lanes &= lanes - 1) {
            block.close(first + first_lane(lanes));
        }
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
