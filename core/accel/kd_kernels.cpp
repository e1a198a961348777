#include "core/accel/kd_kernels.h"

#include <algorithm>
#include <numeric>
#include <optional>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/kd_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/few_objects-inl.h"
#include "core/accel/mesh_apart-inl.h"
#include "core/accel/mesh_sweep-inl.h"
#include "core/accel/triangle_beams-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// What the trace of a batch needs room for. Kept from block to block.
struct Workspace {
    RayBlock block;
    std::uint32_t ids[kBlockRays + kLanes];
    std::vector<MeshCandidate> candidates;
    std::vector<std::uint32_t> first;  ///< One an object: where its candidates begin, sorted by object.
    std::vector<std::uint32_t> sorted;
    std::vector<Hit> hits;  ///< Of rays that only ask whether there is one.
};

template <Query kQuery>
void trace_mesh(const KdScene& scene, std::uint32_t object, std::span<const std::uint32_t> ids,
                std::span<const Ray> rays, std::span<Hit> hits, RayBlock& block) {
    if (scene.in_turn) {
        sweep_mesh<kQuery>(scene, object, ids, rays, hits, block);
        return;
    }
    const MeshTree& mesh = *scene.mesh_trees[object];
    std::uint32_t sorted[kBlockRays];
    if (mesh.tree.apart != 0) ids = sort_by_axis(rays, ids, sorted);
    RayBlockWriter(rays, hits, &scene.objects[object], mesh.tree.bounds, mesh.bounds).write(ids, block);
    if (kQuery == Query::closest && Beam::kSuits) trace_beams(mesh, object, block, rays, hits);
    sweep_apart<kQuery>(mesh, object, block, rays, hits);
    MeshClient<kQuery> client(mesh, object, block, rays, hits);
    if (kQuery == Query::closest) trace_packets(mesh.tree, block, client);
    // With 4 lanes, rays in a closed room took longer.
    if (kQuery == Query::any && kLanes >= 8 && go_together(mesh.tree, block)) {
        trace_convoys(mesh.tree, block, client);
    } else {
        trace_lanes(mesh.tree, block, client);
    }
}

/// Sorts the candidates by object and traces each mesh with its rays, every ray once.
template <Query kQuery>
void trace_candidates(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits, Workspace& work) {
    if (work.candidates.empty()) return;
    work.first.assign(scene.objects.size() + 1, 0);
    for (const MeshCandidate& candidate : work.candidates) ++work.first[candidate.object + 1];
    std::partial_sum(work.first.begin(), work.first.end(), work.first.begin());
    work.sorted.resize(work.candidates.size());
    for (const MeshCandidate& candidate : work.candidates) work.sorted[work.first[candidate.object]++] = candidate.ray;
    std::uint32_t begin = 0;
    for (std::uint32_t object = 0; begin < work.sorted.size(); ++object) {
        const std::uint32_t end = work.first[object];
        if (begin == end) continue;
        bool seen[kBlockRays] = {};
        std::uint32_t count = 0;
        for (; begin < end; ++begin) {
            const std::uint32_t id = work.sorted[begin];
            if (seen[id] || (kQuery == Query::any && hits[id].valid())) continue;
            seen[id] = true;
            work.ids[count++] = id;
        }
        if (count > 0) trace_mesh<kQuery>(scene, object, {work.ids, count}, rays, hits, work.block);
    }
}

/// The object that is the whole scene but for planes, where that is a mesh.
std::optional<std::uint32_t> only_mesh(const KdScene& scene) {
    const ObjectLeaf& apart = scene.leaves->apart;
    if (scene.tree || apart.triangles > 0 || apart.spheres > 0 || apart.others != 1) return std::nullopt;
    const std::uint32_t object = scene.leaves->others[apart.first_other];
    return scene.mesh_trees[object] ? std::optional(object) : std::nullopt;
}

/// Those of all rays of the block that have no answer yet.
template <Query kQuery>
std::span<const std::uint32_t> open_rays(std::span<const Hit> hits, Workspace& work) {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < hits.size(); ++i) {
        work.ids[count] = i;
        count += kQuery == Query::any && hits[i].valid() ? 0 : 1;
    }
    return {work.ids, count};
}

/// `hits` are without a hit before.
template <Query kQuery>
void trace_block(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits, Workspace& work) {
    for (const std::uint32_t index : scene.planes) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (can_hit(rays[i])) intersect_object(scene.objects, index, rays[i], hits[i]);
        }
    }
    // Without planes none has an answer.
    const auto open = scene.planes.empty() ? open_rays<Query::closest>(hits, work) : open_rays<kQuery>(hits, work);
    if (const auto mesh = only_mesh(scene)) {
        trace_mesh<kQuery>(scene, *mesh, open, rays, hits, work.block);
        return;
    }
    work.candidates.clear();
    if (!scene.leaves->apart.empty()) FewObjects<kQuery>(scene, rays, hits, work.candidates).trace(open);
    if (scene.tree) {
        const Bounds3& bounds = scene.tree->bounds;
        RayBlockWriter(rays, hits, nullptr, bounds, bounds).write(open_rays<kQuery>(hits, work), work.block);
        ObjectClient<kQuery> client(scene, work.block, rays, hits, work.candidates);
        trace_packets(*scene.tree, work.block, client);
        trace_lanes(*scene.tree, work.block, client);
    }
    trace_candidates<kQuery>(scene, rays, hits, work);
}

void intersect_batch(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
    Workspace work;
    for (std::size_t i = 0; i < rays.size(); i += kBlockRays) {
        const std::size_t n = std::min(kBlockRays, rays.size() - i);
        std::ranges::fill(hits.subspan(i, n), Hit());
        trace_block<Query::closest>(scene, rays.subspan(i, n), hits.subspan(i, n), work);
    }
}

void occluded_batch(const KdScene& scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
    Workspace work;
    for (std::size_t i = 0; i < rays.size(); i += kBlockRays) {
        const std::size_t n = std::min(kBlockRays, rays.size() - i);
        work.hits.assign(n, Hit());
        trace_block<Query::any>(scene, rays.subspan(i, n), work.hits, work);
        for (std::size_t k = 0; k < n; ++k) blocked[i + k] = work.hits[k].valid() ? 1 : 0;
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(intersect_batch);
HWY_EXPORT(occluded_batch);

void kd_intersect(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
    HWY_DYNAMIC_DISPATCH(intersect_batch)(scene, rays, hits);
}

void kd_occluded(const KdScene& scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
    HWY_DYNAMIC_DISPATCH(occluded_batch)(scene, rays, blocked);
}

}  // namespace rayuela
#endif
