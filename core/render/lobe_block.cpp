#include "core/render/lobe_block.h"

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/lobe_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/lights/light_block_lanes-inl.h"
#include "core/materials/single_lobe_lanes-inl.h"
#include "core/math/float_error.h"
#include "core/math/sampler_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

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

    HWY_INLINE InteractionLanes(const LobeBlock& block, std::size_t i)
        : p(load(block.light.p, i)),
          p_error(load(block.p_error, i)),
          ng(load(block.ng, i)),
          frame(shading_normal(load(block.wo, i), ng, load(block.ns, i))),
          wo_local(frame.to_local(load(block.wo, i))) {}

    static HWY_INLINE Vec3Lanes shading_normal(const Vec3Lanes& w, const Vec3Lanes& ng, const Vec3Lanes& ns) {
        return select(hn::Xor(positive(dot(w, ng)), positive(dot(w, ns))), ng, ns);
    }
    HWY_INLINE FloatMask consistent(const Vec3Lanes& wi, const Vec3Lanes& wi_local) const {
        return positive(dot(wi, ng) * wi_local.z);
    }
    HWY_INLINE Vec3Lanes ray_origin(const Vec3Lanes& wi) const { return offset_ray_origin(p, p_error, ng, wi); }
};

HWY_ATTR void prepare_lights(const LobeTask& task, LobeBlock& block) {
    block.light.size = block.size;
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        const Vec2Lanes u = samplers(task, block, i).get_2d(task.light_dimension);
        store(u.x, block.light.u, i);
        store(u.y, block.light.v, i);
        const InteractionLanes at(block, i);
        const FloatMask behind = hn::Lt(at.wo_local.z, hn::Zero(FloatTag()));
        store(select(behind, -at.frame.n, at.frame.n), block.light.n, i);
    }
}

/// As PathTracer::add_light has it.
template <typename Lobe>
HWY_INLINE FloatMask light_paths(const LobeTask& task, const InteractionLanes& at, const Lobe& lobe, std::size_t i,
                                 LobeBlock& block) {
    const FloatTag d;
    const Floats pdf = load(block.light.pdf, i);
    FloatMask lit = positive(pdf);
    if (hn::AllFalse(d, lit)) return lit;
    const Vec3Lanes wi = load(block.light.wi, i), wi_local = at.frame.to_local(wi);
    const BsdfValueLanes f = lobe.evaluate(at.wo_local, wi_local);
    lit = hn::And(lit, hn::And(at.consistent(wi, wi_local), positive(at.wo_local.z * wi_local.z)));
    lit = hn::And(lit, finite(f.pdf));
    const Floats weight = task.mis ? power_heuristic(pdf, f.pdf) : all_lanes(1.0f);
    const Vec3Lanes arriving = load(block.throughput, i) * f.value * load(block.light.radiance, i) * (weight / pdf);
    lit = hn::And(lit, hn::Not(is_black(arriving)));
    const Vec3Lanes bringing = select(lit, arriving, all_lanes(Vec3(0)));
    if (task.black_shadow_rays) lit = positive(pdf);
    const Vec3Lanes origin = at.ray_origin(wi);
    store(origin, block.shadow_origin, i);
    store(select(hn::Eq(load(block.light.distance, i), all_lanes(kInfinity)), wi, load(block.light.target, i) - origin),
          block.shadow_direction, i);
    store(bringing, block.shadow_light, i);
    return lit;
}

/// As Bsdf::sample has it.
HWY_INLINE FloatMask valid(const Vec3Lanes& wo_local, const BsdfSampleLanes& sample) {
    const FloatMask dense = hn::And(positive(sample.pdf), finite(sample.pdf));
    const FloatMask bright = hn::And(sample.there, hn::Not(is_black(sample.weight)));
    return hn::And(hn::And(positive(hn::Abs(wo_local.z)), bright), dense);
}

/// As PathTracer::scatter has it.
template <typename Lobe>
HWY_INLINE FloatMask scattered_paths(const LobeTask& task, const InteractionLanes& at, const Lobe& lobe, std::size_t i,
                                     LobeBlock& block) {
    const FloatTag d;
    const LobeNumbers numbers{task, samplers(task, block, i)};
    const BsdfSampleLanes sample = lobe.sample(at.wo_local, numbers);
    const Vec3Lanes wi = at.frame.to_world(sample.wi);
    Vec3Lanes throughput = load(block.throughput, i) * sample.weight;
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
    store(at.ray_origin(wi), block.next_origin, i);
    store(wi, block.next_direction, i);
    store(sample.wi, block.next_local, i);
    store(throughput, block.next_throughput, i);
    store(sample.pdf, block.next_pdf, i);
    return goes_on;
}

template <typename Lobe, bool kDelta>
HWY_ATTR void scatter_as(const LobeTask& task, LobeBlock& block) {
    const FloatTag d;
    block.casts_shadow_ray = block.goes_on = 0;
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        const InteractionLanes at(block, i);
        const Lobe lobe(load(block.color, i), load(block.shape, i));
        const FloatMask there = hn::FirstN(d, block.size - i);
        if constexpr (!kDelta) {
            if (task.samples_lights) {
                const FloatMask lit = hn::And(there, light_paths(task, at, lobe, i, block));
                block.casts_shadow_ray |= std::uint64_t{bits_of(d, lit)} << i;
            }
        }
        const FloatMask goes_on = hn::And(there, scattered_paths(task, at, lobe, i, block));
        block.goes_on |= std::uint64_t{bits_of(d, goes_on)} << i;
    }
}

HWY_ATTR void scatter(const LobeTask& task, LobeBlock& block) {
    using Kind = SingleLobe::Kind;
    switch (task.kind) {
        case Kind::matte:
            return scatter_as<MatteLobe, is_delta(Kind::matte)>(task, block);
        case Kind::facets:
            return scatter_as<FacetLobe, is_delta(Kind::facets)>(task, block);
        case Kind::mirror:
            return scatter_as<MirrorLobe, is_delta(Kind::mirror)>(task, block);
        case Kind::glass:
            return scatter_as<GlassLobe, is_delta(Kind::glass)>(task, block);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(prepare_lights);
HWY_EXPORT(scatter);

void prepare_light_samples(const LobeTask& task, LobeBlock& block) {
    HWY_DYNAMIC_DISPATCH(prepare_lights)(task, block);
}

void scatter_lobes(const LobeTask& task, LobeBlock& block) {
    HWY_DYNAMIC_DISPATCH(scatter)(task, block);
}

}  // namespace rayuela
#endif
