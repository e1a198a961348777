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
        // Rays mostly come in their order.
        if (i - unit_.first >= kDoubles) unit_ = UnitDirections(block_, rays_, i);
        const std::size_t k = i - unit_.first;
        ray_of_slot_[slot] = block_.id[i];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            origin_[axis][slot] = block_.origin[axis][i];
            direction_[axis][slot] = unit_.direction[axis][k];
        }
        pad_[slot] = block_.pad[i];
        previous_[slot] = kNone;
        length_[slot] = unit_.length[k];
        begin_[slot] = unit_.begin[k];
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
    /// Of rays first to first + kDoubles of a block.
    struct UnitDirections {
        std::size_t first = kBlockRays;
        alignas(64) float direction[3][kDoubles], begin[kDoubles];  ///< `begin`: as SphereFilterRays has it.
        alignas(64) double length[kDoubles];

        UnitDirections() = default;
        UnitDirections(const RayBlock& block, std::span<const Ray> rays, std::size_t i) : first(i) {
            const DoubleTag dd;
            const hn::Rebind<float, DoubleTag> df;
            hn::Vec<decltype(df)> along[4];
            alignas(64) float t_min[kDoubles];
            const Ray* ray[kDoubles];
            for (std::size_t k = 0; k < kDoubles; ++k) {
                ray[k] = &rays[block.id[std::min(i + k, block.size - 1)]];
                t_min[k] = ray[k]->t_min;
            }
            load_turned(
                df, [&](std::size_t lane) HWY_ATTR { return &ray[lane]->direction.x; }, along);
            const auto exact = [&](std::size_t axis) HWY_ATTR { return hn::PromoteTo(dd, along[axis]); };
            const DoubleAxes d{exact(0), exact(1), exact(2)};
            const Doubles size = hn::Sqrt(dot(d, d));
            const DoubleAxes n = hn::Div(all_doubles(1), size) * d;
            hn::Store(hn::DemoteTo(df, n.x), df, direction[0]);
            hn::Store(hn::DemoteTo(df, n.y), df, direction[1]);
            hn::Store(hn::DemoteTo(df, n.z), df, direction[2]);
            hn::Store(size, dd, length);
            const auto nearest = hn::DemoteTo(df, hn::Mul(size, hn::PromoteTo(dd, hn::Load(df, t_min))));
            hn::Store(hn::Mul(nearest, hn::Set(df, 1 - 4 * kUnitRoundoff)), df, begin);
        }
    };

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
    UnitDirections unit_;         ///< Worked out last.
    SphereCandidates candidates_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
