#include "core/render/lobe_block.h"

#include <cstddef>
#include <type_traits>

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/lobe_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/lights/light_block_lanes-inl.h"
#include "core/materials/frosted_lanes-inl.h"
#include "core/materials/plain_lobes_lanes-inl.h"
#include "core/materials/principled_lanes-inl.h"
#include "core/math/float_error.h"
#include "core/math/fours_lanes-inl.h"
#include "core/math/sampler_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Paths i to i + kLanes of a block.
struct PathLanes {
    const LobePaths& paths;
    const LobeBlock& block;
    std::size_t i;

    HWY_INLINE FourLanes point(std::size_t offset) const {
        static_assert(std::is_standard_layout_v<SurfacePoint> && offsetof(SurfacePoint, uv) == 12 * sizeof(float));
        return load_fours([&](std::size_t lane) HWY_ATTR { return &paths.points[path(lane)].p.x + offset; });
    }
    HWY_INLINE Vec3Lanes ray_direction() const {
        static_assert(std::is_standard_layout_v<Ray> && sizeof(Ray) == 8 * sizeof(float));
        return load_fours([&](std::size_t lane) HWY_ATTR { return &paths.rays[path(lane)].direction.x; }).xyz();
    }
    HWY_INLINE Vec3Lanes throughput() const {
        return load_fours([&](std::size_t lane) HWY_ATTR { return &paths.states[path(lane)].throughput.x; }).xyz();
    }
    HWY_INLINE FourLanes sampler() const {
        static_assert(std::is_standard_layout_v<Sampler> && sizeof(Sampler) == 4 * sizeof(float));
        return load_fours([&](std::size_t lane) HWY_ATTR {
            return reinterpret_cast<const float*>(&paths.samplers[paths.states[path(lane)].part]);
        });
    }
    /// Numbers 4 `group` to 4 `group` + 3 of what the paths are at.
    HWY_INLINE FourLanes numbers(std::size_t group) const {
        return load_fours([&](std::size_t lane) HWY_ATTR { return block.bsdf[i + lane]->numbers.data() + 4 * group; });
    }

private:
    HWY_INLINE std::size_t path(std::size_t lane) const { return block.state[i + lane]; }
};

HWY_INLINE SamplerLanes samplers(const LobeTask& task, const LobeBlock& block, std::size_t i) {
    return {task.sampler, block.key_0 + i, block.key_1 + i, block.reversed_index + i};
}

/// What a lobe is sampled with, drawn where it asks for it.
struct LobeNumbers {
    const LobeTask& task;
    SamplerLanes sampler;

    HWY_INLINE Floats lobe() const { return sampler.get_1d(task.lobe_dimension); }
    HWY_INLINE Vec2Lanes direction() const { return sampler.get_2d(task.direction_dimension); }
};

/// As Interaction has it.
struct InteractionLanes {
    Vec3Lanes p, p_error, ng;
    BasisLanes frame;
    Vec3Lanes wo_local;

    HWY_INLINE InteractionLanes(const LobeTask& task, const LobeBlock& block, std::size_t i)
        : p(load(block.light.p, i)),
          p_error(load(block.p_error, i)),
          ng(load(block.ng, i)),
          frame(task.interpolates ? shading_normal(load(block.wo, i), ng, load(block.ns, i)) : ng),
          wo_local(frame.to_local(load(block.wo, i))) {}

    static HWY_INLINE Vec3Lanes shading_normal(const Vec3Lanes& w, const Vec3Lanes& ng, const Vec3Lanes& ns) {
        return select(hn::Xor(positive(dot(w, ng)), positive(dot(w, ns))), ng, ns);
    }
    HWY_INLINE FloatMask consistent(const Vec3Lanes& wi, const Vec3Lanes& wi_local) const {
        return positive(dot(wi, ng) * wi_local.z);
    }
    HWY_INLINE Vec3Lanes ray_origin(const Vec3Lanes& wi) const { return offset_ray_origin(p, p_error, ng, wi); }
};

HWY_INLINE void store_bits(Floats bits, LobeBlock::WordRow& row, std::size_t i) {
    hn::Store(hn::BitCast(WordTag(), bits), WordTag(), row + i);
}

HWY_INLINE void fetch(const LobeTask& task, const PathLanes& paths, std::size_t i, LobeBlock& block) {
    const FourLanes a = paths.point(0), b = paths.point(4), c = paths.point(8), sampler = paths.sampler();
    store(-paths.ray_direction(), block.wo, i);
    store(a.xyz(), block.light.p, i);
    store(Vec3Lanes{a.w, b.x, b.y}, block.p_error, i);
    store(Vec3Lanes{b.z, b.w, c.x}, block.ng, i);
    if (task.interpolates) store(Vec3Lanes{c.y, c.z, c.w}, block.ns, i);
    store_bits(sampler.x, block.key_0, i);
    store_bits(sampler.y, block.key_1, i);
    store_bits(sampler.z, block.reversed_index, i);
}

HWY_ATTR void prepare(const LobeTask& task, const LobePaths& paths, LobeBlock& block) {
    // Lanes past the last have to be of some path.
    for (std::size_t i = block.size; i % kLanes != 0; ++i) {
        block.state[i] = block.state[0];
        block.bsdf[i] = block.bsdf[0];
    }
    block.light.size = block.size;
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        fetch(task, {paths, block, i}, i, block);
        if (!task.samples_lights) continue;
        const Vec2Lanes u = samplers(task, block, i).get_2d(task.light_dimension);
        store(u.x, block.light.u, i);
        store(u.y, block.light.v, i);
        const InteractionLanes at(task, block, i);
        const Vec3Lanes n = select(below_zero(at.wo_local.z), -at.frame.n, at.frame.n);
        store(transmits(task.kind) ? all_lanes(Vec3(0)) : n, block.light.n, i);
    }
}

HWY_INLINE void store_rays(const Vec3Lanes& origin, const Vec3Lanes& direction, Floats end, Ray* rays) {
    const Floats zero = hn::Zero(FloatTag());
    store_fours(origin.x, origin.y, origin.z, zero, [&](std::size_t lane) HWY_ATTR { return &rays[lane].origin.x; });
    store_fours(direction.x, direction.y, direction.z, end,
                [&](std::size_t lane) HWY_ATTR { return &rays[lane].direction.x; });
}

/// As PathTracer::add_light has it.
template <PackedBsdf::Kind kKind, typename Lobe>
HWY_INLINE FloatMask light_paths(const LobeTask& task, const InteractionLanes& at, const Lobe& lobe,
                                 const Vec3Lanes& throughput, std::size_t i, LobeBlock& block) {
    const FloatTag d;
    const Floats pdf = load(block.light.pdf, i);
    FloatMask lit = positive(pdf);
    if (hn::AllFalse(d, lit)) return lit;
    const Vec3Lanes wi = load(block.light.wi, i), wi_local = at.frame.to_local(wi);
    const BsdfValueLanes f = lobe.evaluate(wi_local);
    const Floats sides = at.wo_local.z * wi_local.z;
    const FloatMask possible = transmits(kKind) ? hn::Ne(sides, hn::Zero(d)) : positive(sides);
    lit = hn::And(lit, hn::And(at.consistent(wi, wi_local), possible));
    lit = hn::And(lit, finite(f.pdf));
    const Floats weight = task.mis ? power_heuristic(pdf, f.pdf) : all_lanes(1.0f);
    const Vec3Lanes arriving = throughput * f.value * load(block.light.radiance, i) * (weight / pdf);
    lit = hn::And(lit, hn::Not(is_black(arriving)));
    const Vec3Lanes bringing = select(lit, arriving, all_lanes(Vec3(0)));
    if (task.black_shadow_rays) lit = positive(pdf);
    const Vec3Lanes origin = at.ray_origin(wi);
    const FloatMask far = hn::Eq(load(block.light.distance, i), all_lanes(kInfinity));
    const Vec3Lanes way = select(far, wi, load(block.light.target, i) - origin);
    const Floats end = hn::IfThenElse(far, all_lanes(kInfinity), all_lanes(1.0f));
    store_rays(origin, way, end, block.shadow_ray + i);
    store_fours(bringing.x, bringing.y, bringing.z, end,
                [&](std::size_t lane) HWY_ATTR { return &block.shadow_light[i + lane].x; });
    return lit;
}

/// As Bsdf::sample has it.
HWY_INLINE FloatMask valid(const Vec3Lanes& wo_local, const BsdfSampleLanes& sample) {
    const FloatMask dense = hn::And(positive(sample.pdf), finite(sample.pdf));
    const FloatMask bright = hn::And(sample.there, hn::Not(is_black(sample.weight)));
    return hn::And(hn::And(positive(hn::Abs(wo_local.z)), bright), dense);
}

/// As PathTracer::scatter has it.
template <PackedBsdf::Kind kKind, typename Lobe>
HWY_INLINE FloatMask scattered_paths(const LobeTask& task, const InteractionLanes& at, const Lobe& lobe,
                                     Vec3Lanes throughput, std::size_t i, LobeBlock& block) {
    const FloatTag d;
    const LobeNumbers numbers{task, samplers(task, block, i)};
    const BsdfSampleLanes sample = lobe.sample(numbers);
    const Vec3Lanes wi = at.frame.to_world(sample.wi);
    throughput = throughput * sample.weight;
    const Floats reach = max_component(throughput);
    FloatMask goes_on = hn::And(valid(at.wo_local, sample), hn::And(at.consistent(wi, sample.wi), positive(reach)));
    const Floats limit = all_lanes(task.roulette_throughput);
    const FloatMask weak = hn::And(goes_on, hn::Lt(reach, limit));
    if (!hn::AllFalse(d, weak)) {
        const Floats survival = reach / limit;
        const Floats number = numbers.sampler.get_1d(task.roulette_dimension);
        goes_on = hn::AndNot(hn::And(weak, hn::Ge(number, survival)), goes_on);
        throughput = select(weak, throughput / survival, throughput);
    }
    store_rays(at.ray_origin(wi), wi, all_lanes(kInfinity), block.next_ray + i);
    store_fours(throughput.x, throughput.y, throughput.z, is_delta(kKind) ? hn::Zero(d) : sample.pdf,
                [&](std::size_t lane) HWY_ATTR { return &block.next_throughput[i + lane].x; });
    store(sample.wi, block.next_local, i);
    return goes_on;
}

template <PackedBsdf::Kind kKind, typename Lobe>
HWY_ATTR void scatter_as(const LobeTask& task, const LobePaths& paths, LobeBlock& block) {
    const FloatTag d;
    block.casts_shadow_ray = block.goes_on = 0;
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        const InteractionLanes at(task, block, i);
        const PathLanes path{paths, block, i};
        const Lobe lobe(path, at.wo_local);
        const Vec3Lanes throughput = path.throughput();
        const FloatMask there = hn::FirstN(d, block.size - i);
        if constexpr (!is_delta(kKind)) {
            if (task.samples_lights) {
                const FloatMask lit = hn::And(there, light_paths<kKind>(task, at, lobe, throughput, i, block));
                block.casts_shadow_ray |= std::uint64_t{bits_of(d, lit)} << i;
            }
        }
        const FloatMask goes_on = hn::And(there, scattered_paths<kKind>(task, at, lobe, throughput, i, block));
        block.goes_on |= std::uint64_t{bits_of(d, goes_on)} << i;
    }
}

HWY_ATTR void scatter(const LobeTask& task, const LobePaths& paths, LobeBlock& block) {
    using Kind = PackedBsdf::Kind;
    switch (task.kind) {
        case Kind::matte:
            return scatter_as<Kind::matte, MatteLobe>(task, paths, block);
        case Kind::facets:
            return scatter_as<Kind::facets, FacetLobe>(task, paths, block);
        case Kind::dull:
            return scatter_as<Kind::dull, DullLobe>(task, paths, block);
        case Kind::mirror:
            return scatter_as<Kind::mirror, MirrorLobe>(task, paths, block);
        case Kind::glass:
            return scatter_as<Kind::glass, GlassLobe>(task, paths, block);
        case Kind::frosted:
            return scatter_as<Kind::frosted, FrostedLobe>(task, paths, block);
        case Kind::layered:
            return scatter_as<Kind::layered, PrincipledLobe<false>>(task, paths, block);
        case Kind::see_through:
            return scatter_as<Kind::see_through, PrincipledLobe<true>>(task, paths, block);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(prepare);
HWY_EXPORT(scatter);

void prepare_lobes(const LobeTask& task, const LobePaths& paths, LobeBlock& block) {
    HWY_DYNAMIC_DISPATCH(prepare)(task, paths, block);
}

void scatter_lobes(const LobeTask& task, const LobePaths& paths, LobeBlock& block) {
    HWY_DYNAMIC_DISPATCH(scatter)(task, paths, block);
}

}  // namespace rayuela
#endif
