// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_FEW_OBJECTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_FEW_OBJECTS_INL_H_
#undef RAYUELA_CORE_ACCEL_FEW_OBJECTS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_FEW_OBJECTS_INL_H_
#endif

#include "core/accel/object_lanes-inl.h"
#include "core/accel/pair_tests-inl.h"
#include "core/accel/rays_by_axis-inl.h"
#include "core/math/fours_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// As many rays of a batch as there are lanes.
struct WorldRays {
    Words id;
    FloatMask usable;  ///< Exists and can hit something.
    Floats origin[3], direction[3];
    Floats t_min, t_end;
    Floats pad;  ///< As RayBlock::pad.

    /// The n (or kLanes, if that is less) rays from `ids` on. `reach` is the largest coordinate of the scene's bounds.
    HWY_INLINE WorldRays(std::span<const Ray> rays, std::span<const Hit> hits, const std::uint32_t* ids, std::size_t n,
                         float reach) {
        static_assert(sizeof(Ray) == 8 * sizeof(float) && sizeof(Hit) == 6 * sizeof(float));
        const FloatTag d;
        id = hn::LoadU(WordTag(), ids);
        const FourLanes from = load_fours([&](std::size_t lane) HWY_ATTR { return &rays[ids[lane]].origin.x; });
        const FourLanes along = load_fours([&](std::size_t lane) HWY_ATTR { return &rays[ids[lane]].direction.x; });
        const FourLanes hit = load_fours([&](std::size_t lane) HWY_ATTR { return &hits[ids[lane]].t; });
        origin[0] = from.x;
        origin[1] = from.y;
        origin[2] = from.z;
        direction[0] = along.x;
        direction[1] = along.y;
        direction[2] = along.z;
        t_min = from.w;
        const Floats t_max = along.w;
        t_end = hn::Min(t_max, hit.x);
        const Floats zero = hn::Zero(d);
        const auto sum_of_nothing = [&](const Floats(&v)[3])
                                        HWY_ATTR { return v[0] * zero + v[1] * zero + v[2] * zero; };
        const auto largest = [](const Floats(&v)[3])
                                 HWY_ATTR { return hn::Max(hn::Abs(v[0]), hn::Max(hn::Abs(v[1]), hn::Abs(v[2]))); };
        const auto finite = hn::Eq(sum_of_nothing(origin) + sum_of_nothing(direction), zero);
        const auto in_range = hn::And(hn::Gt(largest(direction), zero), hn::Le(t_min, t_max));
        usable = hn::And(hn::FirstN(d, n), hn::And(finite, in_range));
        pad = hn::Set(d, 10 * kUnitRoundoff) * (largest(origin) + hn::Set(d, reach));
    }
};

/// Rays of a batch against every object that stands apart from a tree: no order, all lanes full. Rays of one dominant axis go
/// together, so that a triangle is turned once for 16 of them.
template <Query kQuery>
class FewObjects {
public:
    FewObjects(const KdScene& scene, std::span<const Ray> rays, std::span<Hit> hits, std::vector<MeshCandidate>& meshes)
        : scene_(scene), leaf_(scene.leaves->apart), rays_(rays), hits_(hits), meshes_(meshes) {
        const Bounds3& bounds = scene.all_bounds;
        reach_ = rayuela::max_component(glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi)));
    }

    /// `ids`: at most kBlockRays, kLanes more may be read. Meshes are noted down for later, all other shapes tested.
    HWY_INLINE void trace(std::span<const std::uint32_t> ids) {
        by_axis_.sort(rays_, ids);
        trace_axis<0>();
        trace_axis<1>();
        trace_axis<2>();
    }

private:
    static constexpr std::size_t kRoom = 1024;     ///< For candidates.
    static constexpr std::size_t kPairs = 1 << 7;  ///< Tested with all rays before the next, to stay in the cache.

    template <std::uint32_t kAxis>
    void trace_axis() {
        const std::size_t pairs = scene_.leaves->apart_pairs.pairs.size();
        const bool spheres = leaf_.spheres > 0;
        for (std::size_t first = 0; first < pairs; first += kPairs) {
            const std::size_t end = std::min(pairs, first + kPairs);
            each_group(kAxis, [&](const WorldRays& rays) HWY_ATTR {
                add_triangles<kAxis>(rays, first, end);
                // Loading the rays again would take as long as some spheres.
                if (spheres && end == pairs) add_spheres(rays);
            });
            decide_triangles<kAxis>(first);
        }
        if (spheres && pairs == 0) each_group(kAxis, [&](const WorldRays& rays) HWY_ATTR { add_spheres(rays); });
        if (spheres) decide_spheres();
        if (leaf_.others > 0) each_group(kAxis, [&](const WorldRays& rays) HWY_ATTR { test_others(rays); });
    }

    template <typename Each>
    HWY_INLINE void each_group(std::uint32_t axis, const Each& each) {
        std::uint32_t* const ids = by_axis_.ids[axis];
        const std::size_t n = by_axis_.size[axis];
        if (n > 0) std::fill_n(ids + n, kLanes, ids[0]);
        for (std::size_t i = 0; i < n; i += kLanes) each(WorldRays(rays_, hits_, ids + i, n - i, reach_));
    }

    /// Pairs first to end.
    template <std::uint32_t kAxis>
    HWY_INLINE void add_triangles(const WorldRays& rays, std::size_t first, std::size_t end) {
        const FloatTag d;
        const auto [x, y, z] = Turn(kAxis);
        const Floats depth = rays.direction[z];
        const Floats least = hn::Max(hn::Set(d, 1), hn::Abs(depth)) * hn::Set(d, kLeastDepthPad);
        const DepthRange range = depth_range(depth, least, rays.t_min, rays.t_end);
        const FilterRays filter{rays.origin[x],
                                rays.origin[y],
                                rays.origin[z],
                                rays.direction[x] / depth,
                                rays.direction[y] / depth,
                                FilterSlack::of(rays.pad),
                                range.begin,
                                range.end};
        const PairFilter<kAxis> pairs(filter, rays.usable);
        const std::size_t of_two = std::clamp(scene_.leaves->apart_pairs.of_two, first, end);
        test_pairs<kAxis, true>(pairs, rays.id, first, first, of_two);
        test_pairs<kAxis, false>(pairs, rays.id, first, of_two, end);
    }

    /// Pairs begin to end, as candidates counted from `first`.
    template <std::uint32_t kAxis, bool kTwo>
    HWY_INLINE void test_pairs(const PairFilter<kAxis>& filter, Words ids, std::size_t first, std::size_t begin,
                               std::size_t end) {
        const FloatTag d;
        const WordTag dw;
        const TrianglePair* const pairs = scene_.leaves->apart_pairs.pairs.data();
        std::size_t count = count_;
        for (std::size_t i = begin; i < end; ++i) {
            filter.template test<kTwo>(pairs[i], [&](FloatMask hit, std::uint32_t half) HWY_ATTR {
                const std::uint32_t triangle = 2 * static_cast<std::uint32_t>(i - first) + half;
                const Words candidates = ids + hn::Set(dw, candidate(0, triangle));
                hn::StoreU(hn::Compress(candidates, hn::RebindMask(dw, hit)), dw, candidate_ + count);
                count += hn::CountTrue(d, hit);
            });
            if (count > kRoom - 2 * kLanes) {
                count_ = count;
                decide_triangles<kAxis>(first);
                count = 0;
            }
        }
        count_ = count;
    }

    /// A ray of the block, and a triangle of the pairs that are tested: 2 a pair.
    static constexpr std::uint32_t candidate(std::uint32_t ray, std::uint32_t triangle) {
        static_assert((kBlockRays & (kBlockRays - 1)) == 0);
        return triangle * kBlockRays + ray;
    }
    static constexpr std::uint32_t ray_of(std::uint32_t candidate) { return candidate % kBlockRays; }
    static constexpr std::uint32_t triangle_of(std::uint32_t candidate) { return candidate / kBlockRays; }

    /// Pairs are counted from `first`.
    template <std::uint32_t kAxis>
    void decide_triangles(std::size_t first) {
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        using HalfFloats = hn::Vec<decltype(df)>;
        const auto [x, y, z] = Turn(kAxis);
        const std::uint32_t* const names = scene_.leaves->apart_pairs.names.data() + 2 * first;
        // Behind the last candidate are some whose results are dropped.
        hn::StoreU(hn::Zero(WordTag()), WordTag(), candidate_ + count_);
        for (std::size_t i = 0; i < count_; i += kDoubles) {
            std::uint32_t ray[kDoubles], triangle[kDoubles];
            for (std::size_t lane = 0; lane < kDoubles; ++lane) {
                ray[lane] = ray_of(candidate_[i + lane]);
                triangle[lane] = names[triangle_of(candidate_[i + lane])];
            }
            HalfFloats origin[4], direction[4], corners[3][4];
            load_turned(
                df, [&](std::size_t lane) HWY_ATTR { return &rays_[ray[lane]].origin.x; }, origin);
            load_turned(
                df, [&](std::size_t lane) HWY_ATTR { return &rays_[ray[lane]].direction.x; }, direction);
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const auto at = [&](std::size_t lane) HWY_ATTR {
                    return scene_.leaves->apart_corners[triangle[lane]].data() + 4 * corner;
                };
                load_turned(df, at, corners[corner]);
            }
            const auto exact = [&](HalfFloats value) HWY_ATTR { return hn::PromoteTo(dd, value); };
            const auto vertex = [&](std::size_t corner, std::uint32_t axis)
                                    HWY_ATTR { return exact(corners[corner][axis]); };
            const Doubles inverse_z = hn::Div(hn::Set(dd, 1), exact(direction[z]));
            const ExactHits hits = intersect(
                ExactRays{exact(origin[x]), exact(origin[y]), exact(origin[z]), hn::Mul(exact(direction[x]), inverse_z),
                          hn::Mul(exact(direction[y]), inverse_z), inverse_z},
                ExactTriangles{vertex(0, x), vertex(0, y), vertex(0, z), vertex(1, x), vertex(1, y), vertex(1, z),
                               vertex(2, x), vertex(2, y), vertex(2, z)});
            const auto t = hn::DemoteTo(df, hits.t);
            const auto in_range = hn::And(hn::And(hn::Ge(t, origin[3]), hn::Le(t, direction[3])),
                                          hn::Lt(hn::Abs(t), hn::Set(df, kInfinity)));
            alignas(64) double ts[kDoubles], us[kDoubles], vs[kDoubles];
            hn::Store(hits.t, dd, ts);
            hn::Store(hits.u, dd, us);
            hn::Store(hits.v, dd, vs);
            const auto hit = hn::And(hits.hit, hn::FirstN(dd, count_ - i));
            for (LaneBits bits = bits_of(dd, hit) & bits_of(df, in_range); bits != 0; bits &= bits - 1) {
                const std::size_t k = first_lane(bits);
                keep_triangle(scene_.leaves->triangles[triangle[k]], triangle_hit(ts[k], us[k], vs[k]), hits_[ray[k]]);
            }
        }
        count_ = 0;
    }

    HWY_INLINE void add_spheres(const WorldRays& rays) {
        const FloatTag d;
        const SphereFilterRays filter = sphere_filter(rays);
        const float* const runs = scene_.leaves->sphere_runs.data();
        for (std::size_t i = 0, n = leaf_.spheres; i < n; ++i) {
            const auto set = [&](std::size_t run) HWY_ATTR { return hn::Set(d, runs[run * n + i]); };
            const FloatMask hit = may_hit(filter, FilterSpheres{set(0), set(1), set(2), set(3)});
            spheres_.add(rays.id, hn::And(hit, rays.usable), scene_.leaves->spheres[i]);
            if (spheres_.full()) decide_spheres();
        }
    }

    HWY_INLINE void decide_spheres() {
        spheres_.decide(rays_, hits_, scene_.leaves->exact_spheres.data(),
                        [&](std::uint32_t ray, std::uint32_t object, float t)
                            HWY_ATTR { keep_closer({.t = t}, object, 0, hits_[ray]); });
    }

    static HWY_INLINE SphereFilterRays sphere_filter(const WorldRays& rays) {
        const FloatTag d;
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        // The length of a direction of large floats is beyond the range of float: it is used in double.
        alignas(64) float direction[3][kLanes], begin[kLanes], end[kLanes];
        for (std::size_t axis = 0; axis < 3; ++axis) hn::Store(rays.direction[axis], d, direction[axis]);
        hn::Store(rays.t_min, d, begin);
        hn::Store(rays.t_end, d, end);
        for (std::size_t i = 0; i < kLanes; i += hn::MaxLanes(dd)) {
            const auto load = [&](const float* from) HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, from + i)); };
            const auto store = [&](Doubles value, float* to)
                                   HWY_ATTR { hn::Store(hn::DemoteTo(df, value), df, to + i); };
            const Doubles x = load(direction[0]), y = load(direction[1]), z = load(direction[2]);
            const Doubles length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
            const Doubles inverse = hn::Div(hn::Set(dd, 1), length);
            store(hn::Mul(length, load(begin)), begin);
            store(hn::Mul(length, load(end)), end);
            store(hn::Mul(x, inverse), direction[0]);
            store(hn::Mul(y, inverse), direction[1]);
            store(hn::Mul(z, inverse), direction[2]);
        }
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(d, values); };
        return {rays.origin[0],
                rays.origin[1],
                rays.origin[2],
                load(direction[0]),
                load(direction[1]),
                load(direction[2]),
                rays.pad,
                load(begin) * hn::Set(d, 1 - 4 * kUnitRoundoff),
                load(end) * hn::Set(d, 1 + 4 * kUnitRoundoff)};
    }

    HWY_INLINE void test_others(const WorldRays& rays) {
        const FloatTag d;
        const Slabs slabs(rays);
        alignas(64) std::uint32_t ids[kLanes];
        hn::Store(rays.id, WordTag(), ids);
        for (std::uint32_t k = 0; k < leaf_.others; ++k) {
            const std::uint32_t object = scene_.leaves->others[k];
            const FloatMask hit = hn::And(slabs.may_meet(scene_.bounds[object]), rays.usable);
            for (LaneBits bits = bits_of(d, hit); bits != 0; bits &= bits - 1) {
                const std::uint32_t id = ids[first_lane(bits)];
                if (scene_.mesh_trees[object]) {
                    meshes_.push_back({object, id});
                } else {
                    intersect_object(scene_.objects, object, rays_[id], hits_[id]);
                }
            }
        }
    }

    /// Rays against boxes that bound objects: as RayBlock's against the planes of a tree.
    struct Slabs {
        const WorldRays& rays;
        Floats inverse[3], overlap[3];
        FloatMask extreme;  ///< Too long or too short a direction for floats: meets all.

        HWY_INLINE explicit Slabs(const WorldRays& r) : rays(r) {
            const FloatTag d;
            Floats longest = hn::Zero(d);
            for (int axis = 0; axis < 3; ++axis) {
                const Floats size = hn::Max(hn::Abs(r.direction[axis]), hn::Set(d, 0x1p-100f));
                inverse[axis] = hn::Set(d, 1) / hn::CopySignToAbs(size, r.direction[axis]);
                overlap[axis] = r.pad * hn::Abs(inverse[axis]);
                longest = hn::Max(longest, size);
            }
            extreme = hn::Or(hn::Lt(longest, hn::Set(d, 0x1p-60f)), hn::Gt(longest, hn::Set(d, 0x1p60f)));
        }
        HWY_INLINE FloatMask may_meet(const Bounds3& bounds) const {
            const FloatTag d;
            Floats begin = rays.t_min, end = rays.t_end;
            for (int axis = 0; axis < 3; ++axis) {
                const Floats lo = (hn::Set(d, bounds.lo[axis]) - rays.origin[axis]) * inverse[axis];
                const Floats hi = (hn::Set(d, bounds.hi[axis]) - rays.origin[axis]) * inverse[axis];
                begin = hn::Max(begin, hn::Min(lo, hi) - overlap[axis]);
                end = hn::Min(end, hn::Max(lo, hi) + overlap[axis]);
            }
            return hn::Or(extreme, hn::Not(hn::Gt(begin, end)));
        }
    };

    const KdScene& scene_;
    const ObjectLeaf& leaf_;
    std::span<const Ray> rays_;
    std::span<Hit> hits_;
    std::vector<MeshCandidate>& meshes_;
    float reach_;
    RaysByAxis by_axis_;
    std::uint32_t candidate_[kRoom + kLanes];
    std::size_t count_ = 0;
    SphereCandidates spheres_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
