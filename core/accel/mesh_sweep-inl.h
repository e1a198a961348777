// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_MESH_SWEEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_MESH_SWEEP_INL_H_
#undef RAYUELA_CORE_ACCEL_MESH_SWEEP_INL_H_
#else
#define RAYUELA_CORE_ACCEL_MESH_SWEEP_INL_H_
#endif

#include "core/accel/object_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays of a block, all of one dominant axis, against all triangles of a mesh that is one leaf.
template <Query kQuery>
HWY_INLINE void sweep_triangles(const MeshTree& mesh, std::uint32_t object, const RayBlock& block,
                                std::span<const Ray> rays, std::span<Hit> hits) {
    constexpr std::size_t kPart = 8192;  // Floats of blocks that stay in the first cache while all rays pass them.
    const float* const data = mesh.leaf_data.data();
    const std::size_t size = mesh.leaf_data.size() - kRunPadding;
    TrianglePacket packet(block, rays);
    for (std::size_t begin = 0, end = 0; begin < size; begin = end) {
        while (end < size && end - begin < kPart) end += LeafBlock(data + end).size();
        for (std::size_t first = 0; first < block.size; first += kLanes) {
            LaneBits lanes = 0;
            for (std::size_t lane = 0; lane < std::min(kLanes, block.size - first); ++lane) {
                const bool open = kQuery == Query::closest || !hits[block.id[first + lane]].valid();
                lanes |= open ? LaneBits{1} << lane : 0;
            }
            if (lanes == 0) continue;
            packet.start(first, lanes, hits);
            for (std::size_t at = begin; at < end; at += LeafBlock(data + at).size()) {
                const LeafBlock triangles(data + at);
                packet.test(triangles, mask_of(lanes),
                            [&](std::size_t lane, std::size_t i, const ShapeHit& hit) HWY_ATTR {
                                keep_closer(hit, object, triangles.name(i), hits[block.id[first + lane]]);
                            });
            }
        }
    }
}

/// Rays `ids` (at most kBlockRays) of a batch against all triangles of a mesh that is one leaf.
template <Query kQuery>
void sweep_mesh(const KdScene& scene, std::uint32_t object, std::span<const std::uint32_t> ids,
                std::span<const Ray> rays, std::span<Hit> hits, RayBlock& block) {
    const MeshTree& mesh = *scene.mesh_trees[object];
    const RayBlockWriter writer(rays, hits, &scene.objects[object], mesh.bounds, mesh.bounds);
    writer.write(ids, block);
    std::uint32_t sorted[3][kBlockRays];
    std::size_t size[3] = {};
    for (std::size_t i = 0; i < block.size; ++i) {
        const std::uint32_t axis = block.dominant_axis[i];
        if (block.begin[i] <= block.end[i]) sorted[axis][size[axis]++] = block.id[i];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        writer.write({sorted[axis], size[axis]}, block);
        sweep_triangles<kQuery>(mesh, object, block, rays, hits);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
