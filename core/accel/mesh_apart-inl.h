// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_MESH_APART_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_MESH_APART_INL_H_
#undef RAYUELA_CORE_ACCEL_MESH_APART_INL_H_
#else
#define RAYUELA_CORE_ACCEL_MESH_APART_INL_H_
#endif

#include "core/accel/object_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// The rays of a block against the large triangles of a mesh, which stand apart from its tree: each triangle against 16 rays
/// of one dominant axis at once. Then a ray goes no further through the tree than its hit, or not at all if it has its answer.
template <Query kQuery>
void sweep_apart(const MeshTree& mesh, std::uint32_t object, RayBlock& block, std::span<const Ray> rays,
                 std::span<Hit> hits) {
    if (mesh.tree.apart == 0) return;
    const FloatTag d;
    const WordTag dw;
    const KdNode& leaf = mesh.tree.nodes[mesh.tree.apart];
    TrianglePacket packet(block, rays);
    for (std::size_t first = 0; first < block.size; first += kLanes) {
        const FloatMask there = hn::Gt(hn::LoadU(d, block.end + first), hn::Set(d, -kInfinity));
        LaneBits open = bits_of(d, hn::And(there, hn::FirstN(d, block.size - first))), closer = 0;
        while (open != 0) {
            const Words axes = hn::LoadU(dw, block.dominant_axis + first);
            const Words axis = hn::Set(dw, block.dominant_axis[first + first_lane(open)]);
            const LaneBits lanes = open & bits_of(dw, hn::Eq(axes, axis));
            packet.start(first, lanes, hits);
            each_block(mesh, leaf.first(), leaf.count(), [&](const LeafBlock& triangles) HWY_ATTR {
                packet.test(triangles, mask_of(lanes),
                            [&](std::size_t lane, std::size_t i, const ShapeHit& hit) HWY_ATTR {
                                keep_closer(hit, object, triangles.name(i), hits[block.id[first + lane]]);
                                closer |= LaneBits{1} << lane;
                            });
            });
            open &= ~lanes;
        }
        for (; closer != 0; closer &= closer - 1) {
            const std::size_t i = first + first_lane(closer);
            if (kQuery == Query::any) {
                block.close(i);
            } else {
                block.limit[i] = t_end(rays[block.id[i]], hits[block.id[i]]) * block.t_scale[i];
                block.end[i] = std::min(block.end[i], block.limit[i]);
            }
        }
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
