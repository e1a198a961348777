#include "core/render/matte.h"

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/matte.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/math/float_error.h"
#include "core/math/sampler_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Floats load(const MatteBlock::Row& row, std::size_t i) {
    return hn::Load(FloatTag(), row + i);
}
HWY_INLINE Vec3Lanes load(const MatteBlock::Rows& rows, std::size_t i) {
    return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}
HWY_INLINE void store(Floats x, MatteBlock::Row& row, std::size_t i) {
    hn::Store(x, FloatTag(), row + i);
}
HWY_INLINE void store(const Vec3Lanes& v, MatteBlock::Rows& rows, std::size_t i) {
    store(v.x, rows[0], i);
    store(v.y, rows[1], i);
    store(v.z, rows[2], i);
}

HWY_INLINE FloatMask positive(Floats x) {
    return hn::Gt(x, hn::Zero(FloatTag()));
}
HWY_INLINE FloatMask finite_positive(Floats x) {
    return hn::And(positive(x), hn::Lt(x, all_lanes(kInfinity)));
}

HWY_INLINE SamplerLanes samplers(const MatteTask& task, const MatteBlock& block, std::size_t i) {
    return {task.sampler, block.key_0 + i, block.key_1 + i, block.reversed_index + i};
}

/// As Interaction has it.
struct InteractionLanes {
    Vec3Lanes p, p_error, ng;
    BasisLanes frame;
    Vec3Lanes wo_local;

    HWY_INLINE InteractionLanes(const MatteBlock& block, std::size_t i)
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

HWY_ATTR void prepare_lights(const MatteTask& task, MatteBlock& block) {
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

/// As PathTracer::sample_light has it.
HWY_INLINE FloatMask light_paths(const MatteTask& task, const InteractionLanes& at, std::size_t i, MatteBlock& block) {
    const FloatTag d;
    const Floats pdf = load(block.light.pdf, i);
    FloatMask lit = positive(pdf);
    if (hn::AllFalse(d, lit)) return lit;
    const Vec3Lanes wi = load(block.light.wi, i), wi_local = at.frame.to_local(wi);
    lit = hn::And(lit, hn::And(at.consistent(wi, wi_local), positive(at.wo_local.z * wi_local.z)));
    const Floats bsdf_pdf = all_lanes(kInvPi) * hn::Abs(wi_local.z);
    const Floats weight = task.mis ? power_heuristic(pdf, bsdf_pdf) : all_lanes(1.0f);
    const Vec3Lanes value = load(block.albedo, i) * bsdf_pdf;
    const Vec3Lanes arriving = load(block.throughput, i) * value * load(block.light.radiance, i) * (weight / pdf);
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

/// As DiffuseBsdf::sample and PathTracer::scatter have it.
HWY_INLINE FloatMask scattered_paths(const MatteTask& task, const InteractionLanes& at, std::size_t i,
                                     MatteBlock& block) {
    const FloatTag d;
    const Floats zero = hn::Zero(d);
    const SamplerLanes sampler = samplers(task, block, i);
    Vec3Lanes wi_local = sample_cosine_hemisphere(sampler.get_2d(task.direction_dimension));
    wi_local.z = hn::IfThenElse(hn::Lt(at.wo_local.z, zero), hn::Neg(wi_local.z), wi_local.z);
    const Floats pdf = all_lanes(kInvPi) * hn::Abs(wi_local.z);
    const Vec3Lanes wi = at.frame.to_world(wi_local), albedo = load(block.albedo, i);
    Vec3Lanes throughput = load(block.throughput, i) * albedo;
    const Floats reach = max_component(throughput);
    FloatMask goes_on = hn::And(hn::And(positive(hn::Abs(at.wo_local.z)), hn::Not(is_black(albedo))),
                                hn::And(hn::And(positive(pdf), at.consistent(wi, wi_local)), positive(reach)));
    const Floats limit = all_lanes(task.roulette_throughput);
    const FloatMask weak = hn::And(goes_on, hn::Lt(reach, limit));
    if (!hn::AllFalse(d, weak)) {
        const Floats survival = reach / limit;
        goes_on = hn::AndNot(hn::And(weak, hn::Ge(sampler.get_1d(task.roulette_dimension), survival)), goes_on);
        throughput = select(weak, throughput / survival, throughput);
    }
    store(at.ray_origin(wi), block.next_origin, i);
    store(wi, block.next_direction, i);
    store(wi_local, block.next_local, i);
    store(throughput, block.next_throughput, i);
    store(pdf, block.next_pdf, i);
    return goes_on;
}

HWY_ATTR void scatter(const MatteTask& task, MatteBlock& block) {
    const FloatTag d;
    block.casts_shadow_ray = block.goes_on = 0;
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        const InteractionLanes at(block, i);
        const FloatMask there = hn::FirstN(d, block.size - i);
        if (task.samples_lights) {
            const FloatMask lit = hn::And(there, light_paths(task, at, i, block));
            block.casts_shadow_ray |= std::uint64_t{bits_of(d, lit)} << i;
        }
        const FloatMask goes_on = hn::And(there, scattered_paths(task, at, i, block));
        block.goes_on |= std::uint64_t{bits_of(d, goes_on)} << i;
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(prepare_lights);
HWY_EXPORT(scatter);

void prepare_light_samples(const MatteTask& task, MatteBlock& block) {
    HWY_DYNAMIC_DISPATCH(prepare_lights)(task, block);
}

void scatter_matte(const MatteTask& task, MatteBlock& block) {
    HWY_DYNAMIC_DISPATCH(scatter)(task, block);
}

}  // namespace rayuela
#endif
