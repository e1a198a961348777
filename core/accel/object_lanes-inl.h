// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#endif

#include "core/accel/kd_kernels.h"

#include <hwy/cache_control.h>

#include "core/accel/kd_convoy-inl.h"
#include "core/accel/sphere_lanes-inl.h"
#include "core/accel/triangle_lanes-inl.h"
#include "core/accel/triangle_packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

enum class Query { closest, any };

/// After a leaf was visited by the ray in a slot: with an answer it stops, else it needs to look no further than its hit.
/// set_end(slot, t) tells those who test it.
template <Query kQuery, typename Slots, typename SetEnd>
HWY_INLINE void go_on(std::size_t slot, std::size_t i, const RayBlock& block, std::span<const Ray> rays,
                      std::span<const Hit> hits, Slots& slots, const SetEnd& set_end) {
    const std::uint32_t id = block.id[i];
    if (kQuery == Query::any && hits[id].valid()) {
        slots.stop(slot);
    } else {
        const float end = t_end(rays[id], hits[id]);
        set_end(slot, end);
        slots.set_limit(slot, end * block.t_scale[i]);
    }
}

/// visit(block) for the blocks of a leaf.
template <typename Visit>
HWY_INLINE void each_block(const MeshTree& mesh, std::size_t first, std::size_t count, const Visit& visit) {
    for (const float* data = mesh.blocks(first); count > 0;) {
        const LeafBlock block(data);
        visit(block);
        data += block.size();
        count -= block.triangles();
    }
}

HWY_INLINE void prefetch_leaf(const MeshTree& mesh, std::size_t first, std::size_t count) {
    // As many vertices as triangles: what leaves mostly have. Four lines without a count to guess wrong.
    constexpr std::size_t kLine = 16, kOften = 4 * kLine;
    const float* const block = mesh.blocks(first);
    for (std::size_t i = 0; i < kOften; i += kLine) hwy::Prefetch(block + i);
    for (std::size_t i = kOften; i < LeafBlock::kHeader + 5 * count; i += kLine) hwy::Prefetch(block + i);
}

/// Rays of a block on their way through the mesh of one object.
template <Query kQuery>
class MeshClient {
public:
    MeshClient(const MeshTree& mesh, std::uint32_t object, const RayBlock& block, std::span<const Ray> rays,
               std::span<Hit> hits)
        : mesh_(mesh),
          object_(object),
          block_(block),
          rays_(rays),
          hits_(hits),
          triangles_(block, rays),
          packet_(block, rays) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i) {
        const std::uint32_t id = block_.id[i];
        triangles_.start(slot, i, t_end(rays_[id], hits_[id]));
    }

    HWY_INLINE void move(std::size_t from, std::size_t to) { triangles_.move(from, to); }

    HWY_INLINE void prefetch(const LeafVisit& leaf) const { prefetch_leaf(mesh_, leaf.first, leaf.count); }

    template <typename Slots>
    HWY_INLINE void visit(std::span<const LeafVisit> visits, Slots& slots) {
        closer_ = 0;
        for (const LeafVisit& visit : visits) {
            each_block(mesh_, visit.first, visit.count, [&](const LeafBlock& block) HWY_ATTR {
                for (std::size_t i = 0; i < block.triangles(); i += kLanes) {
                    if (triangles_.add(visit.slot, block, i)) decide();
                }
            });
        }
        decide();
        for (; closer_ != 0; closer_ &= closer_ - 1) {
            const auto closer = static_cast<std::size_t>(std::countr_zero(closer_));
            go_on<kQuery>(closer, triangles_.ray(closer), block_, rays_, hits_, slots,
                          [&](std::size_t slot, float end) HWY_ATTR { triangles_.set_end(slot, end); });
        }
    }

    HWY_INLINE void start_packet(std::size_t first, LaneBits lanes) {
        first_ = first;
        packet_.start(first, lanes, hits_);
    }
    HWY_INLINE void visit_packet(const KdNode& leaf, LaneBits lanes, Packet& packet) {
        LaneBits closer = 0;
        prefetch({.slot = 0, .first = leaf.first(), .count = leaf.count()});
        each_block(mesh_, leaf.first(), leaf.count(), [&](const LeafBlock& block) HWY_ATTR {
            packet_.test(block, mask_of(lanes), [&](std::size_t lane, std::size_t i, const ShapeHit& hit) HWY_ATTR {
                keep_closer(hit, object_, block.name(i), hits_[block_.id[first_ + lane]]);
                closer |= LaneBits{1} << lane;
            });
        });
        for (; closer != 0; closer &= closer - 1) {
            go_on<kQuery>(first_lane(closer), first_ + first_lane(closer), block_, rays_, hits_, packet,
                          [&](std::size_t lane, float end) HWY_ATTR { packet_.set_end(lane, end); });
        }
    }

private:
    HWY_INLINE void decide() {
        triangles_.decide([&](std::uint32_t slot, std::uint32_t triangle, const ShapeHit& hit) HWY_ATTR {
            keep_closer(hit, object_, triangle, hits_[block_.id[triangles_.ray(slot)]]);
            closer_ |= std::uint64_t{1} << slot;
        });
    }

    const MeshTree& mesh_;
    std::uint32_t object_;
    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::span<Hit> hits_;
    TriangleLanes triangles_;
    TrianglePacket packet_;
    std::uint64_t closer_ = 0;  ///< Slots whose rays have come upon a hit.
    std::size_t first_ = 0;     ///< Ray of the packet.
};

/// Makes the hit with a triangle of a leaf over objects the best one if it comes before it.
HWY_INLINE void keep_triangle(const ObjectTriangle& triangle, ShapeHit hit, Hit& best) {
    if (triangle.kind != ObjectTriangle::whole) set_quad_parameters(triangle.kind - ObjectTriangle::first_half, hit);
    keep_closer(hit, triangle.object, 0, best);
}

/// A mesh on the way of a ray.
struct MeshCandidate {
    std::uint32_t object, ray;
};

/// Rays of a block on their way through the tree over the objects. Meshes are noted down for later, all other shapes tested
/// at once.
template <Query kQuery>
class ObjectClient {
public:
    ObjectClient(const KdScene& scene, const RayBlock& block, std::span<const Ray> rays, std::span<Hit> hits,
                 std::vector<MeshCandidate>& candidates)
        : scene_(scene),
          leaves_(*scene.leaves),
          block_(block),
          rays_(rays),
          hits_(hits),
          candidates_(candidates),
          triangles_(block, rays),
          packet_(block, rays),
          spheres_(block, rays, leaves_.exact_spheres.data()),
          any_triangles_(leaves_.triangle_runs.size() > kRunPadding),
          any_spheres_(!leaves_.spheres.empty()) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i) {
        const std::uint32_t id = block_.id[i];
        const float end = t_end(rays_[id], hits_[id]);
        ray_of_slot_[slot] = static_cast<std::uint32_t>(i);
        if (any_triangles_) triangles_.start(slot, i, end);
        if (any_spheres_) spheres_.start(slot, i, end);
    }

    HWY_INLINE void prefetch(const LeafVisit&) const {}

    template <typename Slots>
    HWY_INLINE void visit(std::span<const LeafVisit> visits, Slots& slots) {
        for (const LeafVisit& visit : visits) {
            const ObjectLeaf& leaf = leaves_.leaves[visit.first];
            add_triangles(visit.slot, leaf);
            add_spheres(visit.slot, leaf);
            test_others(ray_of_slot_[visit.slot], leaf);
        }
        decide_triangles();
        decide_spheres();
        for (const LeafVisit& visit : visits) {
            go_on<kQuery>(visit.slot, ray_of_slot_[visit.slot], block_, rays_, hits_, slots,
                          [&](std::size_t slot, float end) HWY_ATTR {
                              if (any_triangles_) triangles_.set_end(slot, end);
                              if (any_spheres_) spheres_.set_end(slot, end);
                          });
        }
    }

    HWY_INLINE void start_packet(std::size_t first, LaneBits lanes) {
        first_ = first;
        if (any_triangles_) packet_.start(first, lanes, hits_);
        if (!any_spheres_) return;
        for (; lanes != 0; lanes &= lanes - 1) {
            const std::size_t lane = first_lane(lanes);
            const std::uint32_t id = block_.id[first + lane];
            spheres_.start(lane, first + lane, t_end(rays_[id], hits_[id]));
        }
    }
    HWY_INLINE void visit_packet(const KdNode& node, LaneBits lanes, Packet& packet) {
        const ObjectLeaf& leaf = leaves_.leaves[node.first()];
        const float* const runs = leaves_.triangle_runs.data() + kTriangleRuns * leaf.first_triangle;
        packet_.test(
            runs, leaf.triangles, mask_of(lanes), [&](std::size_t lane, std::size_t i, const ShapeHit& hit) HWY_ATTR {
                keep_triangle(leaves_.triangles[leaf.first_triangle + i], hit, hits_[block_.id[first_ + lane]]);
            });
        const float* const spheres = leaves_.sphere_runs.data() + 4 * leaf.first_sphere;
        for (std::size_t i = 0; i < leaf.spheres; ++i) {
            const std::uint32_t name = leaves_.spheres[leaf.first_sphere + i];
            if (spheres_.add_to_packet(mask_of(lanes), spheres, leaf.spheres, i, name)) decide_spheres();
        }
        for (LaneBits rest = leaf.others > 0 ? lanes : 0; rest != 0; rest &= rest - 1)
            test_others(first_ + first_lane(rest), leaf);
        decide_spheres();
        for (LaneBits rest = lanes; rest != 0; rest &= rest - 1) {
            go_on<kQuery>(first_lane(rest), first_ + first_lane(rest), block_, rays_, hits_, packet,
                          [&](std::size_t lane, float end) HWY_ATTR {
                              if (any_triangles_) packet_.set_end(lane, end);
                              if (any_spheres_) spheres_.set_end(lane, end);
                          });
        }
    }

private:
    HWY_INLINE void add_triangles(std::size_t slot, const ObjectLeaf& leaf) {
        const float* const runs = leaves_.triangle_runs.data() + kTriangleRuns * leaf.first_triangle;
        for (std::size_t i = 0; i < leaf.triangles; i += kLanes) {
            if (triangles_.add(slot, runs, leaf.triangles, i, leaf.first_triangle)) decide_triangles();
        }
    }

    HWY_INLINE void add_spheres(std::size_t slot, const ObjectLeaf& leaf) {
        const float* const runs = leaves_.sphere_runs.data() + 4 * leaf.first_sphere;
        const std::uint32_t* const names = leaves_.spheres.data() + leaf.first_sphere;
        for (std::size_t i = 0; i < leaf.spheres; i += kLanes) {
            if (spheres_.add(slot, runs, leaf.spheres, i, names)) decide_spheres();
        }
    }

    HWY_INLINE void decide_triangles() {
        triangles_.decide([&](std::uint32_t slot, std::uint32_t name, const ShapeHit& hit) HWY_ATTR {
            keep_triangle(leaves_.triangles[name], hit, hits_[block_.id[ray_of_slot_[slot]]]);
        });
    }

    HWY_INLINE void decide_spheres() {
        spheres_.decide(hits_, [&](std::uint32_t ray, std::uint32_t object, float t)
                                   HWY_ATTR { keep_closer({.t = t}, object, 0, hits_[ray]); });
    }

    /// What ray i of the block may meet between its beginning and its closest hit so far.
    HWY_INLINE void test_others(std::size_t i, const ObjectLeaf& leaf) {
        const FloatTag d;
        const std::uint32_t id = block_.id[i];
        for (std::size_t k = 0; k < leaf.others; k += kLanes) {
            const FloatMask meets = may_meet_bounds(i, leaf, k);
            for (LaneBits bits = bits_of(d, hn::And(meets, hn::FirstN(d, leaf.others - k))); bits != 0;
                 bits &= bits - 1) {
                const std::uint32_t object = leaves_.others[leaf.first_other + k + first_lane(bits)];
                if (scene_.mesh_trees[object]) {
                    candidates_.push_back({object, id});
                } else {
                    intersect_object(scene_.objects, object, rays_[id], hits_[id]);
                }
            }
        }
    }

    /// Ray i of the block against the bounds of others k to k + kLanes of a leaf: as against the planes of a tree.
    HWY_INLINE FloatMask may_meet_bounds(std::size_t i, const ObjectLeaf& leaf, std::size_t k) const {
        const FloatTag d;
        const std::uint32_t id = block_.id[i];
        const float* const runs = leaves_.other_bounds.data() + 6 * leaf.first_other + k;
        Floats begin = hn::Set(d, rays_[id].t_min * block_.t_scale[i]);
        Floats end = hn::Set(d, t_end(rays_[id], hits_[id]) * block_.t_scale[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Floats origin = hn::Set(d, block_.origin[axis][i]), inverse = hn::Set(d, block_.inverse[axis][i]);
            const Floats overlap = hn::Set(d, block_.pad[i] * std::fabs(block_.inverse[axis][i]));
            const Floats to_lo = (hn::LoadU(d, runs + axis * leaf.others) - origin) * inverse;
            const Floats to_hi = (hn::LoadU(d, runs + (axis + 3) * leaf.others) - origin) * inverse;
            const Floats enter = hn::Min(to_lo, to_hi) - overlap, leave = hn::Max(to_lo, to_hi) + overlap;
            // Comparisons, because they leave begin and end alone where something is NaN.
            begin = hn::IfThenElse(hn::Gt(enter, begin), enter, begin);
            end = hn::IfThenElse(hn::Lt(leave, end), leave, end);
        }
        return hn::Not(hn::Gt(begin, end));
    }

    const KdScene& scene_;
    const ObjectLeaves& leaves_;
    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::span<Hit> hits_;
    std::vector<MeshCandidate>& candidates_;
    TriangleLanes triangles_;
    TrianglePacket packet_;
    SphereLanes spheres_;
    const bool any_triangles_, any_spheres_;  ///< Whether any leaf has them.
    std::uint32_t ray_of_slot_[kSlots];       ///< In the block.
    std::size_t first_ = 0;                   ///< Ray of the packet.
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
