// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_LANES_INL_H_
#endif

#include "core/accel/triangle_runs.h"
#include "core/shapes/intersect_triangle.h"

#include "core/accel/kd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A ray as the float test of triangles wants it: see RayBlock for the turn of the axes.
struct TriangleFilter {
    std::uint32_t x, y, z;
    float ox, oy, oz, shear_x, shear_y, pad;
    float z_begin, z_end;    ///< The depths, from the origin along z, between which a hit counts.
    float depth, t_min;      ///< Of the direction, with its sign; of the ray.
    std::uint32_t previous;  ///< The triangle decided last.

    HWY_INLINE static TriangleFilter of(const RayBlock& block, std::size_t i, const Ray& ray, float t_max) {
        const std::uint32_t z = block.dominant_axis[i], x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
        TriangleFilter filter{.x = x,
                              .y = y,
                              .z = z,
                              .ox = block.origin[x][i],
                              .oy = block.origin[y][i],
                              .oz = block.origin[z][i],
                              .shear_x = static_cast<float>(block.shear_x[i]),
                              .shear_y = static_cast<float>(block.shear_y[i]),
                              .pad = block.pad[i],
                              .depth = static_cast<float>(1 / block.inverse_z[i]),
                              .t_min = ray.t_min,
                              .previous = kNone};
        filter.set_end(t_max);
        return filter;
    }

    HWY_INLINE void set_end(float t_max) {
        const float from = depth * t_min, to = depth * t_max;
        constexpr float kRounding = 4 * kUnitRoundoff;
        z_begin = std::min(from, to);
        z_end = std::max(from, to);
        z_begin -= pad + kRounding * std::fabs(z_begin);
        z_end += pad + kRounding * std::fabs(z_end);
    }
};

/// False only for triangles that the exact test rejects. With u the unit roundoff and R = |origin| + |bounds|, the sheared
/// vertices are right within 8uR; those of a triangle of extent E that is hit are below 2E; so its edge functions are right
/// within 128uR(E + uR), which is less than 16 pad (E + 1.6 pad). A hit's depth lies between those of the vertices, which are
/// right within pad. That holds with and without fma.
HWY_INLINE FloatMask may_hit(const TriangleFilter& ray, const float* runs, std::size_t n) {
    const FloatTag d;
    const Floats ox = hn::Set(d, ray.ox), oy = hn::Set(d, ray.oy), oz = hn::Set(d, ray.oz);
    const Floats sx = hn::Set(d, ray.shear_x), sy = hn::Set(d, ray.shear_y);
    const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(d, runs + run * n); };
    const Floats az = hn::Sub(load(ray.z), oz), bz = hn::Sub(load(3 + ray.z), oz), cz = hn::Sub(load(6 + ray.z), oz);
    const Floats ax = hn::NegMulAdd(sx, az, hn::Sub(load(ray.x), ox)),
                 ay = hn::NegMulAdd(sy, az, hn::Sub(load(ray.y), oy));
    const Floats bx = hn::NegMulAdd(sx, bz, hn::Sub(load(3 + ray.x), ox)),
                 by = hn::NegMulAdd(sy, bz, hn::Sub(load(3 + ray.y), oy));
    const Floats cx = hn::NegMulAdd(sx, cz, hn::Sub(load(6 + ray.x), ox)),
                 cy = hn::NegMulAdd(sy, cz, hn::Sub(load(6 + ray.y), oy));
    const Floats u = hn::NegMulAdd(cy, bx, hn::Mul(cx, by));
    const Floats v = hn::NegMulAdd(ay, cx, hn::Mul(ax, cy));
    const Floats w = hn::NegMulAdd(by, ax, hn::Mul(bx, ay));
    const Floats pad = hn::Set(d, ray.pad);
    const Floats slack = hn::Mul(hn::Mul(pad, hn::Set(d, 16)), hn::MulAdd(hn::Set(d, 1.6f), pad, load(9)));
    const auto outside =
        hn::And(hn::Lt(hn::Min(u, hn::Min(v, w)), hn::Neg(slack)), hn::Gt(hn::Max(u, hn::Max(v, w)), slack));
    const auto apart = hn::Or(hn::Lt(hn::Max(az, hn::Max(bz, cz)), hn::Set(d, ray.z_begin)),
                              hn::Gt(hn::Min(az, hn::Min(bz, cz)), hn::Set(d, ray.z_end)));
    return hn::Not(hn::Or(outside, apart));
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

    /// Calls accept(i, name, t, u, v) for each triangle added that ray i of the block hits at t within [t_min, t_max].
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

/// difference_of_products, the same to the bit.
HWY_INLINE Doubles exact_difference(Doubles a, Doubles d, Doubles b, Doubles c) {
    const DoubleTag dd;
    const Doubles ad = hn::Mul(a, d), bc = hn::Mul(b, c);
    const Doubles difference = hn::Sub(ad, bc);
    const auto safe = hn::Gt(hn::Abs(difference), hn::Mul(hn::Set(dd, 0x1p-12), hn::Add(hn::Abs(ad), hn::Abs(bc))));
    if (HWY_LIKELY(hn::AllTrue(dd, safe))) return difference;
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_SSE4
    // No fused multiply-add here.
    constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());
    alignas(16) double as[kDoubles], bs[kDoubles], cs[kDoubles], ds[kDoubles];
    hn::Store(a, dd, as);
    hn::Store(b, dd, bs);
    hn::Store(c, dd, cs);
    hn::Store(d, dd, ds);
    for (std::size_t k = 0; k < kDoubles; ++k) as[k] = difference_of_products(as[k], ds[k], bs[k], cs[k]);
    return hn::Load(dd, as);
#else
    const Doubles careful = hn::Add(hn::MulSub(a, d, bc), hn::NegMulAdd(b, c, bc));
    return hn::IfThenElse(safe, difference, careful);
#endif
}

template <typename Accept>
void TriangleLanes::decide_candidates(const Accept& accept) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    const hn::Rebind<std::int32_t, DoubleTag> dw;
    const hn::RebindToSigned<DoubleTag> di;
    constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());
    for (std::size_t i = 0; i < candidates_.size; i += kDoubles) {
        // Past the last candidate lie earlier ones or zeros, whose results are dropped.
        const auto index = hn::PromoteTo(di, hn::LoadU(dw, reinterpret_cast<const std::int32_t*>(candidates_.ray + i)));
        const auto ray = [&](const double* from) HWY_ATTR { return hn::GatherIndex(dd, from, index); };
        const auto vertex = [&](std::size_t axis)
                                HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, candidates_.vertex[axis] + i)); };
        const Doubles ox = ray(block_.turned_origin[0]), oy = ray(block_.turned_origin[1]),
                      oz = ray(block_.turned_origin[2]);
        const Doubles sx = ray(block_.shear_x), sy = ray(block_.shear_y);
        const Doubles az = hn::Sub(vertex(2), oz), bz = hn::Sub(vertex(5), oz), cz = hn::Sub(vertex(8), oz);
        const auto sheared = [&](std::size_t axis, Doubles o, Doubles shear, Doubles z)
                                 HWY_ATTR { return hn::Sub(hn::Sub(vertex(axis), o), hn::Mul(shear, z)); };
        const Doubles ax = sheared(0, ox, sx, az), bx = sheared(3, ox, sx, bz), cx = sheared(6, ox, sx, cz);
        const Doubles ay = sheared(1, oy, sy, az), by = sheared(4, oy, sy, bz), cy = sheared(7, oy, sy, cz);
        const Doubles u = exact_difference(cx, by, cy, bx), v = exact_difference(ax, cy, ay, cx),
                      w = exact_difference(bx, ay, by, ax);
        const Doubles zero = hn::Zero(dd), determinant = hn::Add(hn::Add(u, v), w);
        const auto outside = hn::And(hn::Lt(hn::Min(u, hn::Min(v, w)), zero), hn::Gt(hn::Max(u, hn::Max(v, w)), zero));
        const auto hit = hn::AndNot(outside, hn::And(hn::FirstN(dd, candidates_.size - i), hn::Ne(determinant, zero)));
        const Doubles inverse = hn::Div(hn::Set(dd, 1), determinant);
        const Doubles depth = hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz));
        alignas(64) double t[kDoubles], us[kDoubles], vs[kDoubles];
        hn::Store(hn::Mul(hn::Mul(depth, inverse), ray(block_.inverse_z)), dd, t);
        hn::Store(hn::Mul(v, inverse), dd, us);
        hn::Store(hn::Mul(w, inverse), dd, vs);
        for (LaneBits bits = bits_of(dd, hit); bits != 0; bits &= bits - 1) {
            const std::size_t k = first_lane(bits);
            const std::uint32_t ray_index = candidates_.ray[i + k];
            const Ray& limits = rays_[block_.id[ray_index]];
            const auto at = static_cast<float>(t[k]);
            if (!TRange{limits.t_min, limits.t_max}.contains(at)) continue;
            accept(ray_index, candidates_.name[i + k], at, static_cast<float>(us[k]), static_cast<float>(vs[k]));
        }
    }
    candidates_.size = 0;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
