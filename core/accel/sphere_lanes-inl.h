// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_SPHERE_LANES_INL_H_
#endif

#include "core/accel/sphere_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays, one a slot, against the spheres of leaves: a filter in float for up to kLanes spheres at once, or of one sphere for
/// all rays of a packet, then intersect_sphere, the same to the bit, for what is left of many rays at once. For the world: the
/// block's rays are those of the batch.
class SphereLanes {
public:
    SphereLanes(const RayBlock& block, std::span<const Ray> rays, const SphereD* spheres)
        : block_(block), rays_(rays), spheres_(spheres) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i, float t_max) {
        ray_of_slot_[slot] = block_.id[i];
        const Ray& ray = rays_[block_.id[i]];
        const Vec3d d(ray.direction);
        const double length = glm::length(d);
        const Vec3 n(d / length);
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis][slot] = ray.origin[axis];
            direction_[axis][slot] = n[axis];
        }
        pad_[slot] = block_.pad[i];
        previous_[slot] = kNone;
        length_[slot] = length;
        begin_[slot] = static_cast<float>(length * ray.t_min) * (1 - 4 * kUnitRoundoff);
        set_end(slot, t_max);
    }
    HWY_INLINE void set_end(std::size_t slot, float t_max) {
        end_[slot] = static_cast<float>(length_[slot] * t_max) * (1 + 4 * kUnitRoundoff);
    }

    /// Spheres i to i + kLanes of the n of a leaf; names[k] is the object that sphere k is. True when `decide` must be
    /// called before the next.
    HWY_INLINE bool add(std::size_t slot, const float* runs, std::size_t n, std::size_t i, const std::uint32_t* names) {
        const FloatTag d;
        const auto set = [&](const float* values) HWY_ATTR { return hn::Set(d, values[slot]); };
        const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(d, runs + run * n + i); };
        const FloatMask hit = may_hit(rays(set), FilterSpheres{load(0), load(1), load(2), load(3)});
        for (LaneBits bits = bits_of(d, hn::And(hit, hn::FirstN(d, n - i))); bits != 0; bits &= bits - 1) {
            const std::uint32_t name = names[i + first_lane(bits)];
            // A sphere lies in many leaves of a ray.
            if (name != previous_[slot]) candidates_.add(ray_of_slot_[slot], name);
            previous_[slot] = name;
        }
        return candidates_.full();
    }
    /// Sphere i of the n of a leaf for the rays in slots 0 to kLanes that are in `here`. True as above.
    HWY_INLINE bool add_to_packet(FloatMask here, const float* runs, std::size_t n, std::size_t i, std::uint32_t name) {
        const FloatTag d;
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(d, values); };
        const auto set = [&](std::size_t run) HWY_ATTR { return hn::Set(d, runs[run * n + i]); };
        const FloatMask hit = hn::And(here, may_hit(rays(load), FilterSpheres{set(0), set(1), set(2), set(3)}));
        for (LaneBits bits = bits_of(d, hit); bits != 0; bits &= bits - 1)
            candidates_.add(ray_of_slot_[first_lane(bits)], name);
        return candidates_.full();
    }

    /// Calls accept(ray, object, t) for each sphere added that this ray of the batch hits at t before hits[ray].t.
    template <typename Accept>
    HWY_INLINE void decide(std::span<const Hit> hits, const Accept& accept) {
        candidates_.decide(rays_, hits, spheres_, accept);
    }

private:
    template <typename Take>
    HWY_INLINE SphereFilterRays rays(const Take& take) const {
        return {take(origin_[0]),    take(origin_[1]), take(origin_[2]), take(direction_[0]), take(direction_[1]),
                take(direction_[2]), take(pad_),       take(begin_),     take(end_)};
    }

    const RayBlock& block_;
    std::span<const Ray> rays_;
    const SphereD* spheres_;
    std::uint32_t ray_of_slot_[kSlots];  ///< In the batch.
    std::uint32_t previous_[kSlots];     ///< The sphere added last.
    alignas(64) float origin_[3][kSlots] = {}, direction_[3][kSlots] = {};
    alignas(64) float pad_[kSlots] = {}, begin_[kSlots] = {}, end_[kSlots] = {};
    double length_[kSlots] = {};  ///< Of a direction of large floats: beyond the range of float.
    SphereCandidates candidates_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
