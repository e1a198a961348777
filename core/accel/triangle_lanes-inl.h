// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#endif

#include "core/accel/shared_corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A ray as the float test of triangles wants it: see RayBlock for the turn of the axes.
struct TriangleFilter {
    std::uint32_t x, y, z;
    float ox, oy, oz, shear_x, shear_y, slope, offset, depth_pad;  ///< Slope and offset of the FilterSlack.
    float z_begin, z_end;    ///< The depths, from the origin along z, between which a hit counts.
    float depth, t_min;      ///< Of the direction, with its sign; of the ray.
    std::uint32_t previous;  ///< The triangle decided last.

    HWY_INLINE static TriangleFilter of(const RayBlock& block, std::size_t i, const Ray& ray, float t_max) {
        const auto [x, y, z] = Turn(block.dominant_axis[i]);
        const FilterSlack slack = FilterSlack::of(hn::Set(FloatTag(), block.pad[i]));
        TriangleFilter filter{.x = x,
                              .y = y,
                              .z = z,
                              .ox = block.origin[x][i],
                              .oy = block.origin[y][i],
                              .oz = block.origin[z][i],
                              .shear_x = static_cast<float>(block.shear_x[i]),
                              .shear_y = static_cast<float>(block.shear_y[i]),
                              .slope = hn::GetLane(slack.slope),
                              .offset = hn::GetLane(slack.offset),
                              .depth_pad = block.depth_pad[i],
                              .depth = block.depth[i],
                              .t_min = ray.t_min,
                              .previous = kNone};
        filter.set_end(t_max);
        return filter;
    }

    Turn turn() const { return Turn(z); }
    HWY_INLINE void set_end(float t_max) { depth_range(depth, depth_pad, t_min, t_max, z_begin, z_end); }

    HWY_INLINE FilterRays in_all_lanes() const {
        const auto set = [&](float value) HWY_ATTR { return hn::Set(FloatTag(), value); };
        return {set(ox),      set(oy),   set(oz), set(shear_x), set(shear_y), {set(slope), set(offset)},
                set(z_begin), set(z_end)};
    }
};

/// Up to kLanes triangles of runs of n, from the one that `runs` begins with.
HWY_INLINE FloatMask may_hit(const TriangleFilter& ray, const float* runs, std::size_t n) {
    const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(FloatTag(), runs + run * n); };
    return may_hit(ray.in_all_lanes(),
                   FilterTriangles{load(ray.x), load(ray.y), load(ray.z), load(3 + ray.x), load(3 + ray.y),
                                   load(3 + ray.z), load(6 + ray.x), load(6 + ray.y), load(6 + ray.z), load(9)});
}

/// Rays, one a slot, against the triangles of leaves: a filter in float for up to kLanes triangles at once, then
/// intersect_triangle, the same to the bit, for what is left of many rays at once.
class TriangleLanes {
public:
    TriangleLanes(const RayBlock& block, std::span<const Ray> rays) : block_(block), rays_(rays) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i, float t_max) {
        ray_of_slot_[slot] = static_cast<std::uint32_t>(i);
        filter_[slot] = TriangleFilter::of(block_, i, rays_[block_.id[i]], t_max);
    }
    /// What has a slot gets another one.
    HWY_INLINE void move(std::size_t from, std::size_t to) {
        ray_of_slot_[to] = ray_of_slot_[from];
        filter_[to] = filter_[from];
    }
    std::uint32_t ray(std::size_t slot) const { return ray_of_slot_[slot]; }
    HWY_INLINE void set_end(std::size_t slot, float t_max) { filter_[slot].set_end(t_max); }

    /// Triangles i to i + kLanes of runs of n. Triangle k is called first_name + k. True when `decide` must be called before
    /// the next.
    HWY_INLINE bool add(std::size_t slot, const float* runs, std::size_t n, std::size_t i, std::uint32_t first_name) {
        const FloatMask hit = may_hit(filter_[slot], runs + i, n);
        return add(slot, hit, n - i, {runs + i, n}, nullptr, first_name + static_cast<std::uint32_t>(i));
    }
    /// Triangles i to i + kLanes of a block.
    HWY_INLINE bool add(std::size_t slot, const LeafBlock& block, std::size_t i) {
        const CornerView view = CornerView::of(block);
        const FloatMask hit = view.corners ? may_hit(filter_[slot].in_all_lanes(), filter_[slot].turn(), block, i)
                                           : may_hit(filter_[slot], block.values() + i, block.triangles());
        return add(slot, hit, block.triangles() - i, view.from(i), block.names() + i, 0);
    }

    /// Calls accept(slot, name, ShapeHit) for each triangle added that the slot's ray hits at t within [t_min, t_max].
    template <typename Accept>
    HWY_INLINE void decide(const Accept& accept) {
        // Apart from the filter, which so waits for no branch.
        for (const Found& found : std::span<const Found>(found_, size_)) {
            TriangleFilter& ray = filter_[found.slot];
            for (LaneBits bits = found.candidates; bits != 0; bits &= bits - 1) {
                const std::size_t k = first_lane(bits), to = candidates_.size;
                for (std::size_t i = 0; i < 3; ++i) {
                    const float* const corner = found.view.corner(k, i);
                    candidates_.vertex[3 * i][to] = corner[ray.x * found.view.stride];
                    candidates_.vertex[3 * i + 1][to] = corner[ray.y * found.view.stride];
                    candidates_.vertex[3 * i + 2][to] = corner[ray.z * found.view.stride];
                }
                const std::size_t i = ray_of_slot_[found.slot];
                candidates_.set_ray(to, block_, i, rays_[block_.id[i]]);
                const std::uint32_t name = found.names ? std::bit_cast<std::uint32_t>(found.names[k])
                                                       : found.first_name + static_cast<std::uint32_t>(k);
                candidates_.slot[to] = found.slot;
                candidates_.name[to] = name;
                // A large triangle lies in many leaves of a ray.
                candidates_.size += name == ray.previous ? 0 : 1;
                ray.previous = name;
                if (candidates_.size == Candidates::kCapacity) decide_candidates(accept);
            }
        }
        decide_candidates(accept);
        size_ = 0;
    }

private:
    static constexpr std::size_t kRoom = 2 * kSlots;

    /// What the filter leaves of up to kLanes triangles.
    struct Found {
        CornerView view;
        const float* names;  ///< As LeafBlock has them; null where triangles are called first_name + k.
        std::uint32_t first_name, slot;
        LaneBits candidates;
    };

    /// Triangles to be decided together, x, y, z of their vertices in the turn of their rays.
    struct Candidates {
        static constexpr std::size_t kCapacity = 64;
        alignas(64) float vertex[9][kCapacity];
        alignas(64) double ray[6][kCapacity];  ///< As ExactRays has it.
        alignas(64) float t_min[kCapacity], t_max[kCapacity];
        std::uint32_t slot[kCapacity], name[kCapacity];
        std::size_t size = 0;

        HWY_INLINE void set_ray(std::size_t to, const RayBlock& block, std::size_t i, const Ray& limits) {
            for (std::size_t axis = 0; axis < 3; ++axis) ray[axis][to] = block.turned_origin[axis][i];
            ray[3][to] = block.shear_x[i];
            ray[4][to] = block.shear_y[i];
            ray[5][to] = block.inverse_z[i];
            t_min[to] = limits.t_min;
            t_max[to] = limits.t_max;
        }
    };

    /// What the filter leaves of the next n triangles.
    HWY_INLINE bool add(std::size_t slot, FloatMask hit, std::size_t n, const CornerView& view, const float* names,
                        std::uint32_t first_name) {
        const FloatTag d;
        const LaneBits candidates = bits_of(d, hn::And(hit, hn::FirstN(d, n)));
        found_[size_] = {view, names, first_name, static_cast<std::uint32_t>(slot), candidates};
        size_ += candidates != 0 ? 1 : 0;
        return size_ == kRoom;
    }

    template <typename Accept>
    void decide_candidates(const Accept& accept);

    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::uint32_t ray_of_slot_[kAllSlots];  ///< In the block.
    TriangleFilter filter_[kAllSlots];
    Found found_[kRoom];
    std::size_t size_ = 0;
    Candidates candidates_;
};

template <typename Accept>
void TriangleLanes::decide_candidates(const Accept& accept) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    for (std::size_t i = 0; i < candidates_.size; i += kDoubles) {
        // What lies past the last candidate is arbitrary; its results are dropped.
        const auto ray = [&](std::size_t k) HWY_ATTR { return hn::Load(dd, candidates_.ray[k] + i); };
        const auto vertex = [&](std::size_t k)
                                HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, candidates_.vertex[k] + i)); };
        const ExactHits hits = intersect(ExactRays{ray(0), ray(1), ray(2), ray(3), ray(4), ray(5)},
                                         ExactTriangles{vertex(0), vertex(1), vertex(2), vertex(3), vertex(4),
                                                        vertex(5), vertex(6), vertex(7), vertex(8)});
        // Many lie behind their rays: those that the rays leave from. An infinite t may be rounded to a finite one.
        const auto rounded = hn::DemoteTo(df, hits.t);
        const auto in_range = hn::And(hn::Ge(rounded, hn::Load(df, candidates_.t_min + i)),
                                      hn::Le(rounded, hn::Load(df, candidates_.t_max + i)));
        const auto hit = hn::And(hits.hit, hn::FirstN(dd, candidates_.size - i));
        alignas(64) double t[kDoubles], us[kDoubles], vs[kDoubles];
        hn::Store(hits.t, dd, t);
        hn::Store(hits.u, dd, us);
        hn::Store(hits.v, dd, vs);
        for (LaneBits bits = bits_of(dd, hit) & bits_of(df, in_range); bits != 0; bits &= bits - 1) {
            const std::size_t k = first_lane(bits);
            const ShapeHit found = triangle_hit(t[k], us[k], vs[k]);
            if (std::fabs(found.t) < kInfinity) accept(candidates_.slot[i + k], candidates_.name[i + k], found);
        }
    }
    candidates_.size = 0;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
