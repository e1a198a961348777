// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_PACKETS_INL_H_
#endif

#include "core/accel/leaf_blocks.h"
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
        alignas(64) float t_min[kLanes] = {}, t_max[kLanes] = {};
        for (LaneBits rest = lanes; rest != 0; rest &= rest - 1) {
            const std::size_t lane = first_lane(rest);
            const std::uint32_t id = block_.id[first + lane];
            t_min[lane] = rays_[id].t_min;
            t_max[lane] = t_end(rays_[id], hits[id]);
        }
        const FloatTag d;
        hn::Store(demoted(block_.shear_x + first), d, shear_x_);
        hn::Store(demoted(block_.shear_y + first), d, shear_y_);
        const DepthRange range = depth_range(hn::LoadU(d, block_.depth + first), hn::LoadU(d, block_.depth_pad + first),
                                             hn::Load(d, t_min), hn::Load(d, t_max));
        hn::Store(range.begin, d, z_begin_);
        hn::Store(range.end, d, z_end_);
    }
    HWY_INLINE void set_end(std::size_t lane, float t_max) {
        const std::size_t i = first_ + lane;
        depth_range(block_.depth[i], block_.depth_pad[i], rays_[block_.id[i]].t_min, t_max, z_begin_[lane],
                    z_end_[lane]);
    }

    /// Calls accept(lane, i, ShapeHit) for each ray in `here` that triangle i of n runs hits at t within [t_min, t_max].
    template <typename Accept>
    HWY_INLINE void test(const float* runs, std::size_t n, FloatMask here, const Accept& accept) const {
        const FilterRays rays = filter();
        const TurnedRuns turned(runs, n, turn_);
        for (std::size_t i = 0; i < n; ++i) {
            const LaneBits candidates = bits_of(FloatTag(), hn::And(may_hit(rays, turned.triangle(i)), here));
            if (candidates != 0) decide({runs, n}, i, candidates, accept);
        }
    }
    /// The same for the triangles of a block.
    template <typename Accept>
    HWY_INLINE void test(const LeafBlock& block, FloatMask here, const Accept& accept) const {
        const CornerView view = CornerView::of(block);
        if (!view.corners) return test(block.values(), block.triangles(), here, accept);
        const FloatTag d;
        const FilterRays rays = filter();
        const float* const axis[3] = {view.values + turn_.x * view.stride, view.values + turn_.y * view.stride,
                                      view.values + turn_.z * view.stride};
        alignas(64) float vertices[LeafBlock::kMaxVertices][3][kLanes];
        for (std::size_t i = 0; i < view.stride; ++i) {
            const ShearedVertices vertex =
                shear(rays, hn::Set(d, axis[0][i]), hn::Set(d, axis[1][i]), hn::Set(d, axis[2][i]));
            hn::Store(vertex.x, d, vertices[i][0]);
            hn::Store(vertex.y, d, vertices[i][1]);
            hn::Store(vertex.z, d, vertices[i][2]);
        }
        for (std::size_t i = 0; i < block.triangles(); ++i) {
            const auto corner = [&](std::size_t k) HWY_ATTR {
                const auto& [x, y, z] = vertices[LeafBlock::corner(view.corners[i], k)];
                return ShearedVertices{hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)};
            };
            const Floats extent = hn::Set(d, LeafBlock::extent(view.corners[i]));
            const FloatMask may = may_hit(rays, corner(0), corner(1), corner(2), extent);
            const LaneBits candidates = bits_of(d, hn::And(may, here));
            if (candidates != 0) decide(view, i, candidates, accept);
        }
    }

private:
    HWY_INLINE FilterRays filter() const {
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(FloatTag(), values); };
        const auto of_block = [&](const float* values) HWY_ATTR { return hn::LoadU(FloatTag(), values + first_); };
        return {of_block(block_.origin[turn_.x]),
                of_block(block_.origin[turn_.y]),
                of_block(block_.origin[turn_.z]),
                load(shear_x_),
                load(shear_y_),
                FilterSlack::of(of_block(block_.pad)),
                load(z_begin_),
                load(z_end_)};
    }

    template <typename Accept>
    HWY_INLINE void decide(const CornerView& view, std::size_t i, LaneBits candidates, const Accept& accept) const {
        const DoubleTag dd;
        const std::uint32_t axes[3] = {turn_.x, turn_.y, turn_.z};
        const auto set = [&](std::size_t k)
                             HWY_ATTR { return hn::Set(dd, double{view.coordinate(i, k / 3, axes[k % 3])}); };
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
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
