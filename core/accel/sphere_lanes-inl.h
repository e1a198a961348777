// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#endif

#include "core/shapes/intersect_sphere.h"

#include "core/accel/kd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A ray as the float test of spheres wants it.
struct SphereFilter {
    float ox, oy, oz;     ///< Origin.
    float nx, ny, nz;     ///< Unit direction.
    float pad;            ///< RayBlock::pad.
    float length, t_min;  ///< Of the direction; of the ray.
    float begin, end;     ///< Distances from the origin between which a hit counts.

    HWY_INLINE static SphereFilter of(const Ray& ray, float pad, float t_max) {
        const Vec3d d(ray.direction);
        const double length = glm::length(d);
        const Vec3 n(d / length);
        SphereFilter filter{
            ray.origin.x, ray.origin.y, ray.origin.z, n.x, n.y, n.z, pad, static_cast<float>(length), ray.t_min, 0, 0};
        filter.set_end(t_max);
        return filter;
    }
    HWY_INLINE void set_end(float t_max) {
        begin = length * t_min * (1 - 4 * kUnitRoundoff);
        end = length * t_max * (1 + 4 * kUnitRoundoff);
    }
};

/// False only for spheres that the exact test rejects. With R = |origin| + |bounds| the way from the ray's line to the centre
/// is right within 40uR (rounding of ray and sphere to float, and 8 operations on numbers below 2R): less than 8 pad.
HWY_INLINE FloatMask may_hit(const SphereFilter& ray, const float* runs, std::size_t n) {
    const FloatTag d;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const Floats x = hn::Sub(hn::LoadU(d, runs), set(ray.ox)), y = hn::Sub(hn::LoadU(d, runs + n), set(ray.oy)),
                 z = hn::Sub(hn::LoadU(d, runs + 2 * n), set(ray.oz));
    const Floats reach = hn::Add(hn::LoadU(d, runs + 3 * n), set(8 * ray.pad));
    const Floats along = hn::MulAdd(z, set(ray.nz), hn::MulAdd(y, set(ray.ny), hn::Mul(x, set(ray.nx))));
    const Floats px = hn::NegMulAdd(along, set(ray.nx), x), py = hn::NegMulAdd(along, set(ray.ny), y),
                 pz = hn::NegMulAdd(along, set(ray.nz), z);
    const Floats squared = hn::MulAdd(pz, pz, hn::MulAdd(py, py, hn::Mul(px, px)));
    const auto near = hn::Le(squared, hn::Mul(hn::Mul(reach, reach), set(1 + 16 * kUnitRoundoff)));
    const auto within =
        hn::And(hn::Ge(hn::Add(along, reach), set(ray.begin)), hn::Le(hn::Sub(along, reach), set(ray.end)));
    return hn::And(near, within);
}

/// Rays, one a slot, against the spheres of leaves: a filter in float for up to kLanes spheres at once, then intersect_sphere,
/// the same to the bit, for what is left of many rays at once. For the world: the block's rays are those of the batch.
class SphereLanes {
public:
    SphereLanes(const RayBlock& block, std::span<const Ray> rays, const SphereD* spheres)
        : block_(block), rays_(rays), spheres_(spheres) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i, float t_max) {
        ray_of_slot_[slot] = static_cast<std::uint32_t>(i);
        filter_[slot] = SphereFilter::of(rays_[block_.id[i]], block_.pad[i], t_max);
    }
    HWY_INLINE void set_end(std::size_t slot, float t_max) { filter_[slot].set_end(t_max); }

    /// Spheres i to i + kLanes of the n of a leaf; names[k] is the object that sphere k is. True when `decide` must be
    /// called before the next.
    HWY_INLINE bool add(std::size_t slot, const float* runs, std::size_t n, std::size_t i, const std::uint32_t* names) {
        const FloatTag d;
        const FloatMask hit = hn::And(may_hit(filter_[slot], runs + i, n), hn::FirstN(d, n - i));
        for (LaneBits bits = bits_of(d, hit); bits != 0; bits &= bits - 1) {
            ray_[size_] = ray_of_slot_[slot];
            name_[size_++] = names[i + first_lane(bits)];
        }
        return size_ > kCapacity - kLanes;
    }

    /// Calls accept(i, object, t) for each sphere added that ray i of the block hits at t before hits[i].t.
    template <typename Accept>
    HWY_INLINE void decide(std::span<const Hit> hits, const Accept& accept);

private:
    static constexpr std::size_t kCapacity = 256;

    /// `excess` of spheres first to first + the lanes of a vector, worked out with care where it cancels.
    HWY_INLINE Doubles careful(Doubles excess, hn::Mask<DoubleTag> cancels, std::size_t first) const {
        const DoubleTag dd;
        if (hn::AllFalse(dd, cancels)) return excess;
        alignas(64) double values[hn::MaxLanes(DoubleTag())];
        hn::Store(excess, dd, values);
        for (LaneBits bits = bits_of(dd, cancels); bits != 0; bits &= bits - 1) {
            const std::size_t k = first_lane(bits), at = std::min(first + k, size_ - 1);
            const SphereD& sphere = spheres_[name_[at]];
            values[k] = squared_distance_excess(Vec3d(rays_[block_.id[ray_[at]]].origin), sphere.center, sphere.radius);
        }
        return hn::Load(dd, values);
    }

    const RayBlock& block_;
    std::span<const Ray> rays_;
    const SphereD* spheres_;
    std::uint32_t ray_of_slot_[kSlots];  ///< In the block.
    SphereFilter filter_[kSlots];
    std::uint32_t ray_[kCapacity + 16] = {}, name_[kCapacity + 16] = {};
    std::size_t size_ = 0;
};

template <typename Accept>
HWY_INLINE void SphereLanes::decide(std::span<const Hit> hits, const Accept& accept) {
    const DoubleTag dd;
    const hn::RebindToSigned<DoubleTag> di;
    const hn::Rebind<float, DoubleTag> df;
    constexpr std::size_t kDoubles = hn::MaxLanes(DoubleTag());
    static_assert(sizeof(SphereD) == 4 * sizeof(double) && sizeof(Ray) == 8 * sizeof(float));
    const auto dot = [](Doubles ax, Doubles ay, Doubles az, Doubles bx, Doubles by, Doubles bz)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz)); };
    for (std::size_t i = 0; i < size_; i += kDoubles) {
        alignas(64) std::int64_t sphere[kDoubles];
        alignas(64) std::int32_t ray_field[kDoubles];
        alignas(64) float t_min[kDoubles], t_max[kDoubles];
        for (std::size_t k = 0; k < kDoubles; ++k) {
            // Past the last stand earlier ones or zeros, whose results are dropped.
            const std::size_t at = std::min(i + k, size_ - 1);
            const std::uint32_t id = block_.id[ray_[at]];
            sphere[k] = 4 * static_cast<std::int64_t>(name_[at]);
            ray_field[k] = static_cast<std::int32_t>(8 * id);
            t_min[k] = rays_[id].t_min;
            t_max[k] = std::min(rays_[id].t_max, hits[id].t);
        }
        const auto ray = [&](std::size_t field) HWY_ATTR {
            const auto index = hn::Load(hn::Rebind<std::int32_t, DoubleTag>(), ray_field);
            return hn::PromoteTo(dd, hn::GatherIndex(df, &rays_.data()->origin.x + field, index));
        };
        const auto of_sphere = [&](std::size_t field) HWY_ATTR {
            return hn::GatherIndex(dd, &spheres_->center.x + field, hn::Load(di, sphere));
        };
        const Doubles dx = ray(4), dy = ray(5), dz = ray(6), radius = of_sphere(3);
        const Doubles fx = hn::Sub(ray(0), of_sphere(0)), fy = hn::Sub(ray(1), of_sphere(1)),
                      fz = hn::Sub(ray(2), of_sphere(2));
        const Doubles a = dot(dx, dy, dz, dx, dy, dz), b = hn::Neg(dot(fx, fy, fz, dx, dy, dz));
        const Doubles s = hn::Div(b, a);
        const Doubles px = hn::Add(fx, hn::Mul(s, dx)), py = hn::Add(fy, hn::Mul(s, dy)),
                      pz = hn::Add(fz, hn::Mul(s, dz));
        const Doubles closest = hn::Sqrt(dot(px, py, pz, px, py, pz));
        const Doubles discriminant = hn::Mul(hn::Sub(radius, closest), hn::Add(radius, closest));
        const auto met = hn::And(hn::Ge(discriminant, hn::Zero(dd)), hn::FirstN(dd, size_ - i));
        const Doubles distance = hn::Sqrt(dot(fx, fy, fz, fx, fy, fz));
        const Doubles from_surface = hn::Sub(distance, radius);
        const Doubles c = careful(hn::Mul(from_surface, hn::Add(distance, radius)),
                                  hn::Le(hn::Abs(from_surface), hn::Mul(hn::Set(dd, kSphereCancels), radius)), i);
        const Doubles q = hn::Add(b, hn::CopySign(hn::Sqrt(hn::Mul(a, discriminant)), b));
        const Doubles ta = hn::IfThenZeroElse(hn::Eq(q, hn::Zero(dd)), hn::Div(c, q)), tb = hn::Div(q, a);
        const auto swapped = hn::Gt(ta, tb);
        const auto first = hn::DemoteTo(df, hn::IfThenElse(swapped, tb, ta)),
                   second = hn::DemoteTo(df, hn::IfThenElse(swapped, ta, tb));
        const auto lowest = hn::Load(df, t_min), highest = hn::Load(df, t_max);
        const auto contains = [&](hn::Vec<decltype(df)> t) HWY_ATTR {
            return hn::And(hn::And(hn::Ge(t, lowest), hn::Le(t, highest)), hn::Lt(hn::Abs(t), hn::Set(df, kInfinity)));
        };
        const auto takes_first = contains(first);
        const auto inside = hn::Or(takes_first, contains(second));
        alignas(64) float t[kDoubles];
        hn::Store(hn::IfThenElse(takes_first, first, second), df, t);
        for (LaneBits bits = bits_of(dd, met) & bits_of(df, inside); bits != 0; bits &= bits - 1) {
            const std::size_t k = first_lane(bits);
            accept(ray_[i + k], name_[i + k], t[k]);
        }
    }
    size_ = 0;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
