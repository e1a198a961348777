// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#endif

#include "core/accel/triangle_runs.h"
#include "core/accel/triangle_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// The rays of a packet against the triangles of leaves, each triangle against all of them at once: a filter in float, then
/// intersect_triangle, the same to the bit, for what it leaves. All have the same dominant axis.
class TrianglePacket {
public:
    TrianglePacket(const RayBlock& block, std::span<const Ray> rays) : block_(block), rays_(rays) {}

    /// Rays first to first + kLanes of the block, of which those in `lanes` count, up to the closest hits so far.
    HWY_INLINE void start(std::size_t first, LaneBits lanes, std::span<const Hit> hits) {
        first_ = first;
        turn_ = Turn(block_.dominant_axis[first + first_lane(lanes)]);
        for (LaneBits rest = lanes; rest != 0; rest &= rest - 1) {
            const std::size_t lane = first_lane(rest);
            const std::uint32_t id = block_.id[first + lane];
            shear_x_[lane] = static_cast<float>(block_.shear_x[first + lane]);
            shear_y_[lane] = static_cast<float>(block_.shear_y[first + lane]);
            depth_[lane] = static_cast<float>(1 / block_.inverse_z[first + lane]);
            set_end(lane, t_end(rays_[id], hits[id]));
        }
    }
    HWY_INLINE void set_end(std::size_t lane, float t_max) {
        const std::size_t i = first_ + lane;
        depth_range(depth_[lane], block_.depth_pad[i], rays_[block_.id[i]].t_min, t_max, z_begin_[lane], z_end_[lane]);
    }

    /// Calls accept(lane, i, ShapeHit) for each ray in `here` that triangle i of the n of a leaf hits at t within
    /// [t_min, t_max].
    template <typename Accept>
    HWY_INLINE void test(const float* runs, std::size_t n, FloatMask here, const Accept& accept) const {
        test(runs, n, 0, n, here, accept);
    }
    /// The same with triangles [begin, end) of the n.
    template <typename Accept>
    HWY_INLINE void test(const float* runs, std::size_t n, std::size_t begin, std::size_t end, FloatMask here,
                         const Accept& accept) const {
        const FloatTag d;
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(d, values); };
        const auto of_block = [&](const float* values) HWY_ATTR { return hn::LoadU(d, values + first_); };
        const FilterRays rays{of_block(block_.origin[turn_.x]),
                              of_block(block_.origin[turn_.y]),
                              of_block(block_.origin[turn_.z]),
                              load(shear_x_),
                              load(shear_y_),
                              FilterSlack::of(of_block(block_.pad)),
                              load(z_begin_),
                              load(z_end_)};
        const TurnedRuns turned(runs, n, turn_);
        for (std::size_t i = begin; i < end; ++i) {
            const FloatMask may = may_hit(rays, turned.triangle(i));
            const LaneBits candidates = bits_of(d, hn::And(may, here));
            if (candidates != 0) decide(turned.run, i, candidates, accept);
        }
    }

private:
    template <typename Accept>
    HWY_INLINE void decide(const float* const* run, std::size_t i, LaneBits candidates, const Accept& accept) const {
        const DoubleTag dd;
        const auto set = [&](std::size_t k) HWY_ATTR { return hn::Set(dd, double{run[k][i]}); };
        for (std::size_t lane = 0; lane < kLanes; lane += kDoubles) {
            LaneBits part = candidates >> lane & ((LaneBits{1} << kDoubles) - 1);
            if (part == 0) continue;
            const auto ray = [&](const double* values) HWY_ATTR { return hn::LoadU(dd, values + first_ + lane); };
            const ExactHits hits = intersect(
                ExactRays{ray(block_.turned_origin[0]), ray(block_.turned_origin[1]), ray(block_.turned_origin[2]),
                          ray(block_.shear_x), ray(block_.shear_y), ray(block_.inverse_z)},
                ExactTriangles{set(0), set(1), set(2), set(3), set(4), set(5), set(6), set(7), set(8)});
            alignas(64) double t[kDoubles], u[kDoubles], v[kDoubles];
            hn::Store(hits.t, dd, t);
            hn::Store(hits.u, dd, u);
            hn::Store(hits.v, dd, v);
            for (part &= bits_of(dd, hits.hit); part != 0; part &= part - 1) {
                const std::size_t k = first_lane(part);
                const Ray& limits = rays_[block_.id[first_ + lane + k]];
                const ShapeHit found = triangle_hit(t[k], u[k], v[k]);
                if (!TRange{limits.t_min, limits.t_max}.contains(found.t)) continue;
                accept(lane + k, i, found);
            }
        }
    }

    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::size_t first_ = 0;
    Turn turn_{2};
    alignas(64) float shear_x_[kLanes] = {}, shear_y_[kLanes] = {}, z_begin_[kLanes] = {}, z_end_[kLanes] = {};
    float depth_[kLanes] = {};
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
