// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_BEAM_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_BEAM_HITS_INL_H_
#undef RAYUELA_CORE_ACCEL_BEAM_HITS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_BEAM_HITS_INL_H_
#endif

#include <utility>

#include "core/accel/kd_beams-inl.h"
#include "core/accel/leaf_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// The closest hits of the rays of a beam with the triangles of one object: intersect_triangle, the same to the bit.
class BeamHits {
public:
    static constexpr std::size_t kParts = Beam::kParts;

    BeamHits(const Beam& beam, std::uint32_t object, const RayBlock& block, std::span<const Ray> rays,
             std::span<const Hit> hits)
        : beam_(beam), object_(object), block_(block) {
        for (std::size_t p = 0; p < kParts; ++p) {
            Part& part = parts_[p];
            for (LaneBits lanes = beam.rays[p]; lanes != 0; lanes &= lanes - 1) {
                const std::size_t lane = first_lane(lanes);
                const std::uint32_t id = block.id[beam.first + p * kLanes + lane];
                const Hit& hit = hits[id];
                part.t_min[lane] = rays[id].t_min;
                part.t_max[lane] = rays[id].t_max;
                part.t[lane] = hit.t;
                part.rest[lane] = hit.t_rest;
                part.object[lane] = hit.object;
                part.name[lane] = hit.primitive;
            }
        }
    }

    /// Rays in `candidates` of part p, and triangle i of a view.
    HWY_INLINE void decide(std::size_t p, LaneBits candidates, const CornerView& view, std::size_t i,
                           std::uint32_t name) {
        const DoubleTag dd;
        const std::uint32_t axes[3] = {beam_.turn.x, beam_.turn.y, beam_.turn.z};
        const auto set = [&](std::size_t k)
                             HWY_ATTR { return hn::Set(dd, double{view.coordinate(i, k / 3, axes[k % 3])}); };
        const ExactTriangles triangle{set(0), set(1), set(2), set(3), set(4), set(5), set(6), set(7), set(8)};
        for (std::size_t lane = 0; lane < kLanes; lane += kDoubles) {
            const LaneBits there = candidates >> lane & ((LaneBits{1} << kDoubles) - 1);
            if (there == 0) continue;
            const std::size_t k = beam_.first + p * kLanes + lane;
            const auto ray = [&](const double* values) HWY_ATTR { return hn::LoadU(dd, values + k); };
            const auto origin = [&](std::size_t axis) HWY_ATTR { return hn::Set(dd, beam_.turned_origin[axis]); };
            keep(intersect(ExactRays{origin(0), origin(1), origin(2), ray(block_.shear_x), ray(block_.shear_y),
                                     ray(block_.inverse_z)},
                           triangle),
                 p, lane, there, name);
        }
    }

    /// A ray of part p and triangle i of a view, to be decided with others.
    HWY_INLINE void add(std::size_t p, std::size_t lane, const CornerView& view, std::size_t i, std::uint32_t name) {
        const std::size_t to = size_++, ray = p * kLanes + lane;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* const corner = view.corner(i, k);
            pairs_.vertex[3 * k][to] = corner[beam_.turn.x * view.stride];
            pairs_.vertex[3 * k + 1][to] = corner[beam_.turn.y * view.stride];
            pairs_.vertex[3 * k + 2][to] = corner[beam_.turn.z * view.stride];
        }
        pairs_.shear_x[to] = block_.shear_x[beam_.first + ray];
        pairs_.shear_y[to] = block_.shear_y[beam_.first + ray];
        pairs_.inverse_z[to] = block_.inverse_z[beam_.first + ray];
        pairs_.ray[to] = static_cast<std::uint32_t>(ray);
        pairs_.name[to] = name;
        if (size_ == Pairs::kCapacity) decide_added();
    }
    HWY_INLINE void decide_added() {
        const DoubleTag dd;
        const HalfFloatTag df;
        for (std::size_t i = 0; i < size_; i += kDoubles) {
            const auto origin = [&](std::size_t axis) HWY_ATTR { return hn::Set(dd, beam_.turned_origin[axis]); };
            const auto ray = [&](const double* values) HWY_ATTR { return hn::Load(dd, values + i); };
            const auto vertex = [&](std::size_t k)
                                    HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, pairs_.vertex[k] + i)); };
            const ExactHits hits = intersect(ExactRays{origin(0), origin(1), origin(2), ray(pairs_.shear_x),
                                                       ray(pairs_.shear_y), ray(pairs_.inverse_z)},
                                             ExactTriangles{vertex(0), vertex(1), vertex(2), vertex(3), vertex(4),
                                                            vertex(5), vertex(6), vertex(7), vertex(8)});
            alignas(64) double t[kDoubles], u[kDoubles], v[kDoubles];
            hn::Store(hits.t, dd, t);
            hn::Store(hits.u, dd, u);
            hn::Store(hits.v, dd, v);
            for (LaneBits bits = bits_of(dd, hn::And(hits.hit, hn::FirstN(dd, size_ - i))); bits != 0;
                 bits &= bits - 1) {
                const std::size_t k = first_lane(bits);
                keep(triangle_hit(t[k], u[k], v[k]), pairs_.ray[i + k], pairs_.name[i + k]);
            }
        }
        size_ = 0;
    }

    /// Those of a part that have come upon a closer hit since the last call.
    LaneBits take_closer(std::size_t p) { return std::exchange(parts_[p].closer, 0); }
    /// Up to which t rays of a part look for hits.
    Floats end(std::size_t p) const {
        const FloatTag d;
        return hn::Min(hn::Load(d, parts_[p].t_max), hn::Load(d, parts_[p].t));
    }
    Floats begin(std::size_t p) const { return hn::Load(FloatTag(), parts_[p].t_min); }

    /// Writes the closest hits.
    HWY_INLINE void write(std::span<Hit> hits) const {
        for (std::size_t p = 0; p < kParts; ++p) {
            const Part& part = parts_[p];
            for (LaneBits lanes = part.found; lanes != 0; lanes &= lanes - 1) {
                const std::size_t k = first_lane(lanes);
                hits[block_.id[beam_.first + p * kLanes + k]] = {part.t[k],      part.u[k],    part.v[k],
                                                                 part.object[k], part.name[k], part.rest[k]};
            }
        }
    }

private:
    using HalfFloatTag = hn::Rebind<float, DoubleTag>;
    using HalfWordTag = hn::Rebind<std::uint32_t, DoubleTag>;

    /// Between which t a hit counts, and the closest hit so far.
    struct Part {
        alignas(64) float t_min[kLanes] = {}, t_max[kLanes] = {};
        alignas(64) float t[kLanes] = {}, u[kLanes], v[kLanes], rest[kLanes];
        alignas(64) std::uint32_t object[kLanes], name[kLanes];
        LaneBits found = 0, closer = 0;
    };
    /// Of rays and triangles, x, y, z of the corners in the turn of the beam.
    struct Pairs {
        static constexpr std::size_t kCapacity = 16;
        alignas(64) float vertex[9][kCapacity];
        alignas(64) double shear_x[kCapacity], shear_y[kCapacity], inverse_z[kCapacity];
        std::uint32_t ray[kCapacity], name[kCapacity];
    };

    /// What those of the rays from `lane` of part p that are in `rays` have come upon, if it counts.
    HWY_INLINE void keep(const ExactHits& hits, std::size_t p, std::size_t lane, LaneBits rays, std::uint32_t name) {
        const DoubleTag dd;
        const HalfFloatTag df;
        const HalfWordTag dw;
        Part& part = parts_[p];
        const auto t = hn::DemoteTo(df, hits.t), best = hn::Load(df, part.t + lane);
        const auto in_range =
            hn::And(hn::Ge(t, hn::Load(df, part.t_min + lane)), hn::Le(t, hn::Load(df, part.t_max + lane)));
        const auto sound = hn::And(in_range, hn::Lt(hn::Abs(t), hn::Set(df, kInfinity)));
        const LaneBits hit = rays & bits_of(dd, hits.hit) & bits_of(df, sound);
        const LaneBits closer = hit & bits_of(df, hn::Lt(t, best));
        for (LaneBits ties = hit & bits_of(df, hn::Eq(t, best)); ties != 0; ties &= ties - 1) {
            const std::size_t k = first_lane(ties);
            alignas(64) double ts[kDoubles], us[kDoubles], vs[kDoubles];
            hn::Store(hits.t, dd, ts);
            hn::Store(hits.u, dd, us);
            hn::Store(hits.v, dd, vs);
            keep(triangle_hit(ts[k], us[k], vs[k]), p * kLanes + lane + k, name);
        }
        if (closer == 0) return;
        const auto mask = lanes_of(closer);
        const auto words = hn::RebindMask(dw, mask);
        hn::BlendedStore(t, mask, df, part.t + lane);
        hn::BlendedStore(hn::DemoteTo(df, hits.t - hn::PromoteTo(dd, t)), mask, df, part.rest + lane);
        hn::BlendedStore(hn::DemoteTo(df, hits.u), mask, df, part.u + lane);
        hn::BlendedStore(hn::DemoteTo(df, hits.v), mask, df, part.v + lane);
        hn::BlendedStore(hn::Set(dw, name), words, dw, part.name + lane);
        hn::BlendedStore(hn::Set(dw, object_), words, dw, part.object + lane);
        part.closer |= closer << lane;
        part.found |= closer << lane;
    }
    /// What a ray has come upon, if it counts.
    HWY_INLINE void keep(const ShapeHit& hit, std::size_t ray, std::uint32_t name) {
        Part& part = parts_[ray / kLanes];
        const std::size_t k = ray % kLanes;
        if (!TRange{part.t_min[k], part.t_max[k]}.contains(hit.t)) return;
        const Hit best{part.t[k], part.u[k], part.v[k], part.object[k], part.name[k], part.rest[k]};
        if (!is_closer({hit.t, hit.u, hit.v, object_, name, hit.t_rest}, best)) return;
        part.t[k] = hit.t;
        part.u[k] = hit.u;
        part.v[k] = hit.v;
        part.rest[k] = hit.t_rest;
        part.object[k] = object_;
        part.name[k] = name;
        part.closer |= LaneBits{1} << k;
        part.found |= LaneBits{1} << k;
    }

    static HWY_INLINE hn::Mask<HalfFloatTag> lanes_of(LaneBits bits) {
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
        return hn::LoadMaskBits(HalfFloatTag(), bytes);
    }

    const Beam& beam_;
    std::uint32_t object_;
    const RayBlock& block_;
    Part parts_[kParts];
    Pairs pairs_;
    std::size_t size_ = 0;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
