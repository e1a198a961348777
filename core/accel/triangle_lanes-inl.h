// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#endif

#include "core/accel/triangle_runs.h"

#include "core/accel/triangle_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A ray as the float test of triangles wants it: see RayBlock for the turn of the axes.
struct TriangleFilter {
    std::uint32_t x, y, z;
    float ox, oy, oz, shear_x, shear_y, pad, depth_pad;
    float z_begin, z_end;    ///< The depths, from the origin along z, between which a hit counts.
    float depth, t_min;      ///< Of the direction, with its sign; of the ray.
    std::uint32_t previous;  ///< The triangle decided last.

    HWY_INLINE static TriangleFilter of(const RayBlock& block, std::size_t i, const Ray& ray, float t_max) {
        const auto [x, y, z] = Turn(block.dominant_axis[i]);
        TriangleFilter filter{.x = x,
                              .y = y,
                              .z = z,
                              .ox = block.origin[x][i],
                              .oy = block.origin[y][i],
                              .oz = block.origin[z][i],
                              .shear_x = static_cast<float>(block.shear_x[i]),
                              .shear_y = static_cast<float>(block.shear_y[i]),
                              .pad = block.pad[i],
                              .depth_pad = block.depth_pad[i],
                              .depth = static_cast<float>(1 / block.inverse_z[i]),
                              .t_min = ray.t_min,
                              .previous = kNone};
        filter.set_end(t_max);
        return filter;
    }

    HWY_INLINE void set_end(float t_max) { depth_range(depth, depth_pad, t_min, t_max, z_begin, z_end); }
};

/// Up to kLanes triangles of a leaf, from the one that `runs` begins with.
HWY_INLINE FloatMask may_hit(const TriangleFilter& ray, const float* runs, std::size_t n) {
    const FloatTag d;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(d, runs + run * n); };
    return may_hit(FilterRays{set(ray.ox), set(ray.oy), set(ray.oz), set(ray.shear_x), set(ray.shear_y),
                              FilterSlack::of(set(ray.pad)), set(ray.z_begin), set(ray.z_end)},
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
    std::uint32_t ray(std::size_t slot) const { return ray_of_slot_[slot]; }
    HWY_INLINE void set_end(std::size_t slot, float t_max) { filter_[slot].set_end(t_max); }

    /// Triangles i to i + kLanes of the n of a leaf. Triangle k of the leaf is called names[k], or first_name + k where
    /// `names` is null. True when `decide` must be called before the next.
    HWY_INLINE bool add(std::size_t slot, const float* runs, std::size_t n, std::size_t i, const std::uint32_t* names,
                        std::uint32_t first_name) {
        const FloatTag d;
        const FloatMask hit = hn::And(may_hit(filter_[slot], runs + i, n), hn::FirstN(d, n - i));
        found_[size_++] = {runs + i,
                           n,
                           names ? names + i : nullptr,
                           first_name + static_cast<std::uint32_t>(i),
                           static_cast<std::uint32_t>(slot),
                           bits_of(d, hit)};
        return size_ == kRoom;
    }

    /// Calls accept(i, name, ShapeHit) for each triangle added that ray i of the block hits at t within [t_min, t_max].
    template <typename Accept>
    HWY_INLINE void decide(const Accept& accept) {
        // Apart from the filter, which so waits for no branch.
        for (const Found& found : std::span<const Found>(found_, size_)) {
            TriangleFilter& ray = filter_[found.slot];
            const std::size_t n = found.run_length;
            for (LaneBits bits = found.candidates; bits != 0; bits &= bits - 1) {
                const std::size_t k = first_lane(bits), to = candidates_.size;
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    candidates_.vertex[3 * corner][to] = found.runs[(3 * corner + ray.x) * n + k];
                    candidates_.vertex[3 * corner + 1][to] = found.runs[(3 * corner + ray.y) * n + k];
                    candidates_.vertex[3 * corner + 2][to] = found.runs[(3 * corner + ray.z) * n + k];
                }
                const std::uint32_t name =
                    found.names ? found.names[k] : found.first_name + static_cast<std::uint32_t>(k);
                candidates_.ray[to] = ray_of_slot_[found.slot];
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
        const float* runs;
        std::size_t run_length;
        const std::uint32_t* names;
        std::uint32_t first_name, slot;
        LaneBits candidates;
    };

    /// Triangles to be decided together, x, y, z of their vertices in the turn of their rays.
    struct Candidates {
        static constexpr std::size_t kCapacity = 64;
        alignas(64) float vertex[9][kCapacity];
        std::uint32_t ray[kCapacity] = {}, name[kCapacity];
        std::size_t size = 0;
    };

    template <typename Accept>
    void decide_candidates(const Accept& accept);

    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::uint32_t ray_of_slot_[kSlots];  ///< In the block.
    TriangleFilter filter_[kSlots];
    Found found_[kRoom];
    std::size_t size_ = 0;
    Candidates candidates_;
};

template <typename Accept>
void TriangleLanes::decide_candidates(const Accept& accept) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    const hn::Rebind<std::int32_t, DoubleTag> dw;
    const hn::RebindToSigned<DoubleTag> di;
    for (std::size_t i = 0; i < candidates_.size; i += kDoubles) {
        // Past the last candidate lie earlier ones or zeros, whose results are dropped.
        const auto index = hn::PromoteTo(di, hn::LoadU(dw, reinterpret_cast<const std::int32_t*>(candidates_.ray + i)));
        const auto ray = [&](const double* from) HWY_ATTR { return hn::GatherIndex(dd, from, index); };
        const auto vertex = [&](std::size_t axis)
                                HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, candidates_.vertex[axis] + i)); };
        const ExactHits hits = intersect(
            ExactRays{ray(block_.turned_origin[0]), ray(block_.turned_origin[1]), ray(block_.turned_origin[2]),
                      ray(block_.shear_x), ray(block_.shear_y), ray(block_.inverse_z)},
            ExactTriangles{vertex(0), vertex(1), vertex(2), vertex(3), vertex(4), vertex(5), vertex(6), vertex(7),
                           vertex(8)});
        const auto hit = hn::And(hits.hit, hn::FirstN(dd, candidates_.size - i));
        alignas(64) double t[kDoubles], us[kDoubles], vs[kDoubles];
        hn::Store(hits.t, dd, t);
        hn::Store(hits.u, dd, us);
        hn::Store(hits.v, dd, vs);
        for (LaneBits bits = bits_of(dd, hit); bits != 0; bits &= bits - 1) {
            const std::size_t k = first_lane(bits);
            const std::uint32_t ray_index = candidates_.ray[i + k];
            const Ray& limits = rays_[block_.id[ray_index]];
            const ShapeHit found = triangle_hit(t[k], us[k], vs[k]);
            if (!TRange{limits.t_min, limits.t_max}.contains(found.t)) continue;
            accept(ray_index, candidates_.name[i + k], found);
        }
    }
    candidates_.size = 0;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
