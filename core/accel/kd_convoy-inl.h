// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_KD_CONVOY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_KD_CONVOY_INL_H_
#undef RAYUELA_CORE_ACCEL_KD_CONVOY_INL_H_
#else
#define RAYUELA_CORE_ACCEL_KD_CONVOY_INL_H_
#endif

#include "core/accel/kd_packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Neighbours of a block that ask only whether something is in their way. Where enough of them go through a node they do so
/// together: it is loaded once for all. What only few have still to visit is left to them, to go on in lanes. A leaf is tested
/// by each of them as by a ray in a lane, many leaves at once.
class Convoy {
public:
    /// The rays that are to go on.
    LaneBits left() const { return left_; }

    /// Puts the ray of a lane into a slot of the group.
    template <typename Client>
    HWY_INLINE void hand_over(std::size_t lane, const RayBlock& block, LaneGroup& group, std::size_t slot,
                              Client& client) {
        left_ &= ~(LaneBits{1} << lane);
        client.move(kSlots + lane, slot);
        group.start(slot % kLanes, block, first_ + lane, {rest_[lane], size_[lane]});
    }

    /// Takes rays first to first + kLanes of the block through the tree, as far as they go together.
    template <typename Client>
    HWY_INLINE void trace(const KdTree& tree, const RayBlock& block, std::size_t first, Client& client) {
        const FloatTag d;
        const Floats begin = hn::LoadU(d, block.begin + first), end = hn::LoadU(d, block.end + first);
        first_ = first;
        left_ = 0;
        active_ = bits_of(d, hn::And(hn::FirstN(d, block.size - first), hn::Le(begin, end)));
        if (active_ == 0) return;
        std::fill_n(size_, kLanes, 0);
        for (LaneBits lanes = active_; lanes != 0; lanes &= lanes - 1)
            client.start(kSlots + first_lane(lanes), first + first_lane(lanes));
        descend(tree, block, begin, end, client);
        for (std::size_t lane = 0; lane < kLanes; ++lane) left_ |= (size_[lane] > 0 ? LaneBits{1} : 0) << lane;
        left_ &= active_;
    }

    // As the slots of a client.
    void set_limit(std::size_t, float) {}
    void stop(std::size_t slot) { active_ &= ~(LaneBits{1} << (slot - kSlots)); }

private:
    struct Entry {
        alignas(64) float begin[kLanes];
        alignas(64) float end[kLanes];
        std::uint32_t node;
        LaneBits lanes;
    };
    /// A node, the rays that go through it, and where they are in it.
    struct Way {
        std::uint32_t node;
        LaneBits lanes;
        Floats begin, end;
    };

    HWY_INLINE void prepare(const RayBlock& block) {
        const FloatTag d;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Floats inverse = hn::LoadU(d, block.inverse[axis] + first_);
            hn::Store(inverse, d, inverse_[axis]);
            hn::Store(hn::LoadU(d, block.origin[axis] + first_), d, origin_[axis]);
            hn::Store(hn::LoadU(d, block.pad + first_) * hn::Abs(inverse), d, overlap_[axis]);
            backwards_[axis] = bits_of(d, hn::Lt(inverse, hn::Zero(d)));
            above_first_[axis] = 2 * std::popcount(backwards_[axis] & active_) > std::popcount(active_);
        }
        hn::Store(hn::LoadU(d, block.limit + first_), d, limit_);
    }

    template <typename Client>
    HWY_NOINLINE void descend(const KdTree& tree, const RayBlock& block, Floats begin, Floats end, Client& client) {
        prepare(block);
        const KdNode* const nodes = tree.nodes.data();
        Way here{0, active_, begin, end};
        full_ = false;
        while (true) {
            const KdNode node = nodes[here.node];
            if (node.is_leaf()) {
                if (visits_ + kLanes > kVisits) flush(client);
                add_visits(node, here.lanes, client);
            } else if (static_cast<std::size_t>(std::popcount(here.lanes)) < kFew && !full_) {
                leave(here);
            } else {
                hwy::Prefetch(nodes + node.children());
                const auto [first, second] = split(node, here);
                if (first.lanes != 0 && second.lanes != 0) push(second);
                if ((first.lanes | second.lanes) != 0) {
                    here = first.lanes != 0 ? first : second;
                    continue;
                }
            }
            do {
                if (height_ == 0) return flush(client);
                here = pop();
            } while (here.lanes == 0);
        }
    }

    /// What goes through the children: the one that most rays meet first comes first; for the others it is the far one.
    HWY_INLINE std::pair<Way, Way> split(const KdNode& node, const Way& here) const {
        const FloatTag d;
        const auto axis = static_cast<std::size_t>(node.axis());
        const Floats inverse = hn::Load(d, inverse_[axis]), overlap = hn::Load(d, overlap_[axis]);
        const Floats distance = hn::Set(d, node.split()) - hn::Load(d, origin_[axis]);
        const Floats enter = hn::MulSub(distance, inverse, overlap), leave = hn::MulAdd(distance, inverse, overlap);
        const LaneBits beyond = bits_of(d, hn::Gt(enter, hn::Min(here.end, hn::Load(d, limit_))));
        const LaneBits before = bits_of(d, hn::Lt(leave, here.begin));
        const LaneBits to_far = here.lanes & ~beyond, to_near = here.lanes & ~(before & ~beyond);
        const Floats near_end = hn::Min(leave, here.end), far_begin = hn::Max(enter, here.begin);
        const std::uint32_t first = above_first_[axis] ? 1 : 0, second = 1 - first;
        const LaneBits common = first ? backwards_[axis] : ~backwards_[axis];
        const FloatMask first_is_near = mask_of(common);
        return {
            {node.children() + first, node.is_empty(first) ? 0 : (common & to_near) | (~common & to_far),
             hn::IfThenElse(first_is_near, here.begin, far_begin), hn::IfThenElse(first_is_near, near_end, here.end)},
            {node.children() + second, node.is_empty(second) ? 0 : (common & to_far) | (~common & to_near),
             hn::IfThenElse(first_is_near, far_begin, here.begin), hn::IfThenElse(first_is_near, here.end, near_end)}};
    }

    HWY_INLINE void push(const Way& way) {
        Entry& entry = stack_[height_++];
        entry.node = way.node;
        entry.lanes = way.lanes;
        hn::Store(way.begin, FloatTag(), entry.begin);
        hn::Store(way.end, FloatTag(), entry.end);
    }
    HWY_INLINE Way pop() {
        const Entry& entry = stack_[--height_];
        return {entry.node, entry.lanes & active_, hn::Load(FloatTag(), entry.begin), hn::Load(FloatTag(), entry.end)};
    }

    /// To be gone by each ray alone.
    HWY_INLINE void leave(const Way& way) {
        alignas(64) float begin[kLanes], end[kLanes];
        hn::Store(way.begin, FloatTag(), begin);
        hn::Store(way.end, FloatTag(), end);
        for (LaneBits lanes = way.lanes; lanes != 0; lanes &= lanes - 1) {
            const std::size_t lane = first_lane(lanes);
            rest_[lane][size_[lane]++] = {begin[lane], end[lane], std::bit_cast<float>(way.node), 0};
            full_ |= size_[lane] == kMaxRest;
        }
    }

    template <typename Client>
    HWY_INLINE void add_visits(const KdNode& leaf, LaneBits lanes, Client& client) {
        client.prefetch({.slot = 0, .first = leaf.first(), .count = leaf.count()});
        for (; lanes != 0; lanes &= lanes - 1) {
            visit_[visits_++] = {static_cast<std::uint32_t>(kSlots + first_lane(lanes)), leaf.first(), leaf.count()};
        }
    }
    template <typename Client>
    HWY_NOINLINE void flush(Client& client) {
        client.visit(std::span<const LeafVisit>(visit_, visits_), *this);
        visits_ = 0;
    }

    static constexpr std::size_t kFew = kLanes / 4 + 1, kVisits = 4 * kLanes;

    std::size_t first_ = 0;
    alignas(64) LaneAxes origin_, inverse_, overlap_;
    alignas(64) float limit_[kLanes];
    LaneBits backwards_[3];
    bool above_first_[3];             ///< Which child comes first.
    LaneBits active_ = 0, left_ = 0;  ///< Without an answer; of those, to go on.
    std::uint32_t size_[kLanes];
    WayEntry rest_[kLanes][kMaxRest];  ///< What the rays have still to visit, nearest first.
    bool full_ = false;                ///< One can be left no more.
    LeafVisit visit_[kVisits];
    std::size_t visits_ = 0;
    Entry stack_[kKdMaxDepth + 1];
    std::size_t height_ = 0;
};

/// The rays of a block, as convoys leave them.
template <typename Client>
class ConvoyRays {
public:
    ConvoyRays(const KdTree& tree, const RayBlock& block, Client& client)
        : tree_(tree), block_(block), client_(client) {}

    HWY_INLINE bool start(LaneGroup& group, std::size_t slot) {
        while (convoy_.left() == 0) {
            if (next_ >= block_.size) return false;
            convoy_.trace(tree_, block_, next_, client_);
            next_ += kLanes;
        }
        convoy_.hand_over(first_lane(convoy_.left()), block_, group, slot, client_);
        return true;
    }

private:
    const KdTree& tree_;
    const RayBlock& block_;
    Client& client_;
    std::size_t next_ = 0;
    Convoy convoy_;
};

/// Whether rays first to first + kLanes of the block, of one dominant axis, enter the tree close to each other and stay so:
/// the wider apart they enter, the less their slopes may differ.
HWY_INLINE bool stay_close(const KdTree& tree, const RayBlock& block, std::size_t first) {
    // A sixteenth of the tree apart they must be parallel. Rays from the walls of a room around a ball take longer together.
    constexpr float kPerPart = 8, kMost = 1.0f / 2;
    const FloatTag d;
    const auto load = [&](const float* values) HWY_ATTR { return hn::LoadU(d, values + first); };
    const Floats begin = load(block.begin);
    const FloatMask open = hn::And(hn::FirstN(d, block.size - first), hn::Le(begin, load(block.end)));
    float apart = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        apart = std::max(apart, spread(load(block.origin[axis]) + begin / load(block.inverse[axis]), open));
    const float turn =
        std::max(spread(demoted(block.shear_x + first), open), spread(demoted(block.shear_y + first), open));
    return kPerPart * apart / rayuela::max_component(tree.bounds.extent()) + turn <= kMost;
}

/// Whether most neighbours of the block, by a sample, go through the tree close to each other.
HWY_INLINE bool go_together(const KdTree& tree, const RayBlock& block) {
    constexpr std::size_t kEvery = 4 * kLanes;
    int together = 0;
    for (std::size_t first = 0; first < block.size; first += kEvery) {
        const bool alike = Packet(block, first).coherent(tree.bounds) && stay_close(tree, block, first);
        together += alike ? 1 : -1;
    }
    return together > 0;
}

/// trace_lanes of rays that ask only whether something is in their way, of which most go together at first.
template <typename Client>
HWY_INLINE void trace_convoys(const KdTree& tree, const RayBlock& block, Client& client) {
    ConvoyRays<Client> rays(tree, block, client);
    trace_rays(tree, rays, client);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
