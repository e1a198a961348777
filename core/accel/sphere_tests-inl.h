// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_SPHERE_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_SPHERE_TESTS_INL_H_
#undef RAYUELA_CORE_ACCEL_SPHERE_TESTS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_SPHERE_TESTS_INL_H_
#endif

#include "core/shapes/intersect_sphere.h"

#include "core/accel/kd_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"
#include "core/math/precise_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays, or one ray in all lanes.
struct SphereFilterRays {
    Floats ox, oy, oz;  ///< Origin.
    Floats nx, ny, nz;  ///< Unit direction.
    Floats pad;         ///< RayBlock::pad.
    Floats begin, end;  ///< Distances from the origin between which a hit counts.
};

/// Spheres, or one sphere in all lanes.
struct FilterSpheres {
    Floats x, y, z, radius;
};

/// False only for spheres that the exact test rejects. With R = |origin| + |bounds| the way from the ray's line to the centre
/// is right within 40uR (rounding of ray and sphere to float, and 8 operations on numbers below 2R): less than 8 pad.
HWY_INLINE FloatMask may_hit(const SphereFilterRays& ray, const FilterSpheres& sphere) {
    const FloatTag d;
    const Floats x = sphere.x - ray.ox, y = sphere.y - ray.oy, z = sphere.z - ray.oz;
    const Floats reach = sphere.radius + hn::Set(d, 8) * ray.pad;
    const Floats along = hn::MulAdd(z, ray.nz, hn::MulAdd(y, ray.ny, x * ray.nx));
    const Floats px = hn::NegMulAdd(along, ray.nx, x), py = hn::NegMulAdd(along, ray.ny, y),
                 pz = hn::NegMulAdd(along, ray.nz, z);
    const Floats squared = hn::MulAdd(pz, pz, hn::MulAdd(py, py, px * px));
    // What overflows may be a hit: comparisons with a NaN are false.
    const auto far = hn::Gt(squared, reach * reach * hn::Set(d, 1 + 16 * kUnitRoundoff));
    const auto apart = hn::Or(hn::Lt(along + reach, ray.begin), hn::Gt(along - reach, ray.end));
    return hn::Not(hn::Or(far, apart));
}

/// Pairs of a ray of a batch and a sphere object that the filter has left, to be decided many at once by intersect_sphere, the
/// same to the bit.
class SphereCandidates {
public:
    HWY_INLINE void add(std::uint32_t ray, std::uint32_t object) {
        ray_[size_] = ray;
        name_[size_++] = object;
    }
    /// The rays of the lanes in `hit`.
    HWY_INLINE void add(Words rays, FloatMask hit, std::uint32_t object) {
        const FloatTag d;
        const WordTag dw;
        hn::StoreU(hn::Compress(rays, hn::RebindMask(dw, hit)), dw, ray_ + size_);
        hn::StoreU(hn::Set(dw, object), dw, name_ + size_);
        size_ += hn::CountTrue(d, hit);
    }
    /// Whether there may be no room for kLanes more.
    bool full() const { return size_ > kCapacity - kLanes; }

    /// Calls accept(ray, object, t) for each pair where the ray hits the sphere at t before hits[ray].t; then there are none.
    template <typename Accept>
    HWY_INLINE void decide(std::span<const Ray> rays, std::span<const Hit> hits, const SphereD* spheres,
                           const Accept& accept);

private:
    static constexpr std::size_t kCapacity = 256;

    std::uint32_t ray_[kCapacity] = {}, name_[kCapacity] = {};
    std::size_t size_ = 0;
};

template <typename Accept>
HWY_INLINE void SphereCandidates::decide(std::span<const Ray> rays, std::span<const Hit> hits, const SphereD* spheres,
                                         const Accept& accept) {
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    static_assert(sizeof(SphereD) == 4 * sizeof(double));
    for (std::size_t i = 0; i < size_; i += kDoubles) {
        const Ray* ray[kDoubles];
        const SphereD* sphere[kDoubles];
        alignas(64) float t_min[kDoubles], t_max[kDoubles];
        for (std::size_t k = 0; k < kDoubles; ++k) {
            // Past the last stand earlier ones or zeros, whose results are dropped.
            const std::size_t at = std::min(i + k, size_ - 1);
            const std::uint32_t id = ray_[at];
            sphere[k] = spheres + name_[at];
            ray[k] = &rays[id];
            t_min[k] = rays[id].t_min;
            t_max[k] = std::min(rays[id].t_max, hits[id].t);
        }
        hn::Vec<decltype(df)> origin[4], direction[4];
        load_turned(
            df, [&](std::size_t lane) HWY_ATTR { return &ray[lane]->origin.x; }, origin);
        load_turned(
            df, [&](std::size_t lane) HWY_ATTR { return &ray[lane]->direction.x; }, direction);
        Doubles center[2], rest[2];
        load_turned(
            dd, [&](std::size_t lane) HWY_ATTR { return &sphere[lane]->center.x; }, center);
        load_turned(
            dd, [&](std::size_t lane) HWY_ATTR { return &sphere[lane]->center.z; }, rest);
        const auto exact = [&](hn::Vec<decltype(df)> value) HWY_ATTR { return hn::PromoteTo(dd, value); };
        const DoubleAxes d{exact(direction[0]), exact(direction[1]), exact(direction[2])};
        const DoubleAxes from{exact(origin[0]), exact(origin[1]), exact(origin[2])};
        const DoubleAxes middle{center[0], center[1], rest[0]}, f = from - middle;
        const Doubles radius = rest[1], a = dot(d, d), b = hn::Neg(dot(f, d));
        const DoubleAxes nearest = f + hn::Div(b, a) * d;
        const Doubles closest = hn::Sqrt(dot(nearest, nearest));
        const Doubles discriminant = hn::Mul(hn::Sub(radius, closest), hn::Add(radius, closest));
        const auto met = hn::And(hn::Ge(discriminant, hn::Zero(dd)), hn::FirstN(dd, size_ - i));
        const Doubles distance = hn::Sqrt(dot(f, f)), from_surface = hn::Sub(distance, radius);
        const auto cancels = hn::Le(hn::Abs(from_surface), hn::Mul(hn::Set(dd, kSphereCancels), radius));
        Doubles c = hn::Mul(from_surface, hn::Add(distance, radius));
        if (!hn::AllFalse(dd, cancels)) c = hn::IfThenElse(cancels, squared_distance_excess(from, middle, radius), c);
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
