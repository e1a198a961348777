// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#undef RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#else
#define RAYUELA_CORE_ACCEL_OBJECT_LANES_INL_H_
#endif

#include "core/accel/kd_kernels.h"

#include "core/accel/kd_lanes-inl.h"
#include "core/accel/sphere_lanes-inl.h"
#include "core/accel/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

enum class Query { closest, any };

/// After the leaves visited were decided: rays with an answer stop, the others need to look no further than their hits.
/// set_end(slot, t) tells those who test them.
template <Query kQuery, typename SetEnd>
HWY_INLINE void go_on(std::span<const LeafVisit> visits, const TriangleLanes& lanes, const RayBlock& block,
                      std::span<const Ray> rays, std::span<const Hit> hits, LaneGroups& groups, const SetEnd& set_end) {
    for (const LeafVisit& visit : visits) {
        const std::uint32_t i = lanes.ray(visit.slot), id = block.id[i];
        if (kQuery == Query::any && hits[id].valid()) {
            groups.stop(visit.slot);
        } else {
            const float end = t_end(rays[id], hits[id]);
            set_end(visit.slot, end);
            groups.set_limit(visit.slot, end * block.t_scale[i]);
        }
    }
}

/// Rays of a block on their way through the mesh of one object.
template <Query kQuery>
class MeshClient {
public:
    MeshClient(const MeshTree& mesh, std::uint32_t object, const RayBlock& block, std::span<const Ray> rays,
               std::span<Hit> hits)
        : mesh_(mesh), object_(object), block_(block), rays_(rays), hits_(hits), triangles_(block, rays) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i) {
        const std::uint32_t id = block_.id[i];
        triangles_.start(slot, i, t_end(rays_[id], hits_[id]));
    }

    HWY_INLINE void visit(std::span<const LeafVisit> visits, LaneGroups& groups) {
        for (const LeafVisit& visit : visits) {
            const std::size_t n = visit.leaf->count(), first = visit.leaf->first();
            const float* const runs = mesh_.leaf_data.data() + kTriangleRuns * first;
            const std::uint32_t* const names = mesh_.tree.references.data() + first;
            for (std::size_t i = 0; i < n; i += kLanes) {
                if (triangles_.add(visit.slot, runs, n, i, names, 0)) decide();
            }
        }
        decide();
        go_on<kQuery>(visits, triangles_, block_, rays_, hits_, groups,
                      [&](std::size_t slot, float end) HWY_ATTR { triangles_.set_end(slot, end); });
    }

private:
    HWY_INLINE void decide() {
        triangles_.decide([&](std::uint32_t i, std::uint32_t triangle, float t, float u, float v) HWY_ATTR {
            keep_closer({.t = t, .u = u, .v = v}, object_, triangle, hits_[block_.id[i]]);
        });
    }

    const MeshTree& mesh_;
    std::uint32_t object_;
    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::span<Hit> hits_;
    TriangleLanes triangles_;
};

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
          spheres_(block, rays, leaves_.exact_spheres.data()) {}

    HWY_INLINE void start(std::size_t slot, std::size_t i) {
        const std::uint32_t id = block_.id[i];
        const float end = t_end(rays_[id], hits_[id]);
        triangles_.start(slot, i, end);
        if (!leaves_.spheres.empty()) spheres_.start(slot, i, end);
    }

    HWY_INLINE void visit(std::span<const LeafVisit> visits, LaneGroups& groups) {
        for (const LeafVisit& visit : visits) {
            const ObjectLeaf& leaf = leaves_.leaves[visit.leaf->first()];
            add_triangles(visit.slot, leaf);
            add_spheres(visit.slot, leaf);
            for (std::uint32_t k = 0; k < leaf.others; ++k) test(visit.slot, leaves_.others[leaf.first_other + k]);
        }
        decide_triangles();
        decide_spheres();
        go_on<kQuery>(visits, triangles_, block_, rays_, hits_, groups, [&](std::size_t slot, float end) HWY_ATTR {
            triangles_.set_end(slot, end);
            spheres_.set_end(slot, end);
        });
    }

private:
    HWY_INLINE void add_triangles(std::size_t slot, const ObjectLeaf& leaf) {
        const float* const runs = leaves_.triangle_runs.data() + kTriangleRuns * leaf.first_triangle;
        for (std::size_t i = 0; i < leaf.triangles; i += kLanes) {
            if (triangles_.add(slot, runs, leaf.triangles, i, nullptr, leaf.first_triangle)) decide_triangles();
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
        triangles_.decide([&](std::uint32_t i, std::uint32_t name, float t, float u, float v) HWY_ATTR {
            const ObjectTriangle& triangle = leaves_.triangles[name];
            ShapeHit hit{.t = t, .u = u, .v = v};
            if (triangle.kind != ObjectTriangle::whole)
                set_quad_parameters(triangle.kind - ObjectTriangle::first_half, hit);
            keep_closer(hit, triangle.object, 0, hits_[block_.id[i]]);
        });
    }

    HWY_INLINE void decide_spheres() {
        spheres_.decide(hits_, [&](std::uint32_t i, std::uint32_t object, float t)
                                   HWY_ATTR { keep_closer({.t = t}, object, 0, hits_[block_.id[i]]); });
    }

    HWY_INLINE void test(std::size_t slot, std::uint32_t object) {
        const std::uint32_t id = block_.id[triangles_.ray(slot)];
        if (scene_.mesh_trees[object]) {
            candidates_.push_back({object, id});
        } else {
            intersect_object(scene_.objects, object, rays_[id], hits_[id]);
        }
    }

    const KdScene& scene_;
    const ObjectLeaves& leaves_;
    const RayBlock& block_;
    std::span<const Ray> rays_;
    std::span<Hit> hits_;
    std::vector<MeshCandidate>& candidates_;
    TriangleLanes triangles_;
    SphereLanes spheres_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
