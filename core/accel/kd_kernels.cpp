#include "core/accel/kd_kernels.h"

#include "core/accel/kd_ray.h"

#include <algorithm>
#include <cstring>

// The filter below needs no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/accel/kd_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/kd_traversal-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, 16>;
using Floats = hn::Vec<FloatTag>;

enum class Query { closest, any };

/// One ray in the space of one mesh.
class MeshTest {
public:
    MeshTest(const MeshTree& mesh, const RayD& ray, const TriangleRay& triangle_ray, std::uint32_t object, float t_min,
             float t_max)
        : mesh_(mesh), exact_(triangle_ray), object_(object), t_min_(t_min), t_max_(t_max), origin_(ray.origin) {
        const Bounds3& bounds = mesh.tree.bounds;
        const Vec3 farthest = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
        const float reach = max_component(glm::abs(origin_)) + max_component(farthest);
        slack_per_extent_ = 160 * kUnitRoundoff * reach;
        slack_ = slack_per_extent_ * (16 * kUnitRoundoff * reach);
    }

    /// Tests the leaf's triangles; false when the query is answered.
    template <Query kQuery>
    HWY_INLINE bool visit(const KdNode& leaf, Hit& best) const {
        const FloatTag d;
        const std::size_t n = leaf.count();
        const float* const runs = mesh_.leaf_data.get() + MeshTree::kRuns * leaf.first();
        for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
            std::uint64_t candidates = 0;
            hn::StoreMaskBits(d, hn::And(may_hit(runs + i, n), hn::FirstN(d, n - i)),
                              reinterpret_cast<std::uint8_t*>(&candidates));
            for (; candidates != 0; candidates &= candidates - 1) {
                const std::size_t k = i + static_cast<std::size_t>(std::countr_zero(candidates));
                if (!test_exactly(runs + k, n, mesh_.tree.references[leaf.first() + k], best)) continue;
                if (kQuery == Query::any) return false;
            }
        }
        return true;
    }

private:
    /// False only for triangles that the exact test rejects. With u the unit roundoff and R = |origin| + |bounds|, the sheared
    /// vertices are right within 8uR; those of a triangle of extent E that is hit are below 2E; so its edge functions are
    /// right within 128uR(E + uR). That holds with and without fma.
    HWY_INLINE hn::Mask<FloatTag> may_hit(const float* runs, std::size_t n) const {
        const FloatTag d;
        const auto x = static_cast<std::size_t>(exact_.kx), y = static_cast<std::size_t>(exact_.ky),
                   z = static_cast<std::size_t>(exact_.kz);
        const Floats ox = hn::Set(d, origin_[exact_.kx]), oy = hn::Set(d, origin_[exact_.ky]),
                     oz = hn::Set(d, origin_[exact_.kz]);
        const Floats sx = hn::Set(d, static_cast<float>(exact_.shear_x)),
                     sy = hn::Set(d, static_cast<float>(exact_.shear_y));
        const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(d, runs + run * n); };
        const Floats az = hn::Sub(load(z), oz), bz = hn::Sub(load(3 + z), oz), cz = hn::Sub(load(6 + z), oz);
        const Floats ax = hn::NegMulAdd(sx, az, hn::Sub(load(x), ox)), ay = hn::NegMulAdd(sy, az, hn::Sub(load(y), oy));
        const Floats bx = hn::NegMulAdd(sx, bz, hn::Sub(load(3 + x), ox)),
                     by = hn::NegMulAdd(sy, bz, hn::Sub(load(3 + y), oy));
        const Floats cx = hn::NegMulAdd(sx, cz, hn::Sub(load(6 + x), ox)),
                     cy = hn::NegMulAdd(sy, cz, hn::Sub(load(6 + y), oy));
        const Floats u = hn::NegMulAdd(cy, bx, hn::Mul(cx, by));
        const Floats v = hn::NegMulAdd(ay, cx, hn::Mul(ax, cy));
        const Floats w = hn::NegMulAdd(by, ax, hn::Mul(bx, ay));
        const Floats slack = hn::MulAdd(hn::Set(d, slack_per_extent_), load(9), hn::Set(d, slack_));
        const auto outside =
            hn::And(hn::Lt(hn::Min(u, hn::Min(v, w)), hn::Neg(slack)), hn::Gt(hn::Max(u, hn::Max(v, w)), slack));
        return hn::Not(outside);
    }

    HWY_INLINE bool test_exactly(const float* runs, std::size_t n, std::uint32_t triangle, Hit& best) const {
        const auto vertex = [&](std::size_t corner) {
            const float* p = runs + 3 * corner * n;
            return Vec3(p[0], p[n], p[2 * n]);
        };
        ShapeHit hit;
        const TRange range{t_min_, std::min(t_max_, best.t)};
        if (!intersect_triangle(exact_, vertex(0), vertex(1), vertex(2), range, hit)) return false;
        keep_closer(hit, object_, triangle, best);
        return true;
    }

    const MeshTree& mesh_;
    TriangleRay exact_;
    std::uint32_t object_;
    float t_min_, t_max_;
    Vec3 origin_;
    float slack_per_extent_, slack_;
};

template <Query kQuery>
HWY_INLINE void intersect_mesh(const MeshTree& mesh, const TracedObject& object, std::uint32_t index,
                               const TracedRay& world, const Ray& ray, Hit& best) {
    const float t_max = std::min(ray.t_max, best.t);
    const RayD local = object.in_world ? world.ray : object.to_local.ray(world.ray);
    const KdRay kd_ray(local, mesh.tree.bounds, ray.t_min, t_max);
    if (kd_ray.begin > kd_ray.end) return;
    const MeshTest test(mesh, local, object.in_world ? world.triangle_ray : TriangleRay(local), index, ray.t_min,
                        t_max);
    traverse(
        mesh.tree, kd_ray, [&] { return best.t; },
        [&](const KdNode& leaf) HWY_ATTR { return test.template visit<kQuery>(leaf, best); });
}

template <Query kQuery>
Hit trace(const KdScene& scene, const Ray& ray) {
    Hit best;
    if (!can_hit(ray)) return best;
    const TracedRay world{RayD(ray)};
    const auto test_shape = [&](std::uint32_t index) {
        ShapeHit hit;
        const TRange range{ray.t_min, std::min(ray.t_max, best.t)};
        if (intersect_shape(scene.objects[index], world, range, hit)) keep_closer(hit, index, hit.primitive, best);
    };
    const auto answered = [&] { return kQuery == Query::any && best.valid(); };
    for (const std::uint32_t index : scene.planes) {
        test_shape(index);
        if (answered()) return best;
    }
    if (scene.tree->references.empty()) return best;
    const KdRay kd_ray(world.ray, scene.tree->bounds, ray.t_min, std::min(ray.t_max, best.t));
    traverse(
        *scene.tree, kd_ray, [&] { return best.t; },
        [&](const KdNode& leaf) HWY_ATTR {
            for (std::uint32_t i = 0; i < leaf.count(); ++i) {
                const std::uint32_t index = scene.tree->references[leaf.first() + i];
                if (const MeshTree* mesh = scene.mesh_trees[index]) {
                    intersect_mesh<kQuery>(*mesh, scene.objects[index], index, world, ray, best);
                } else {
                    test_shape(index);
                }
                if (answered()) return false;
            }
            return true;
        });
    return best;
}

void intersect_batch(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace<Query::closest>(scene, rays[i]);
}

void occluded_batch(const KdScene& scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
    for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = trace<Query::any>(scene, rays[i]).valid() ? 1 : 0;
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
