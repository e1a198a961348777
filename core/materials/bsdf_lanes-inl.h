// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATERIALS_BSDF_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATERIALS_BSDF_LANES_INL_H_
#undef RAYUELA_CORE_MATERIALS_BSDF_LANES_INL_H_
#else
#define RAYUELA_CORE_MATERIALS_BSDF_LANES_INL_H_
#endif

#include "core/materials/microfacet_lanes-inl.h"
#include "core/math/fours_lanes-inl.h"

// The Bsdfs that are a PackedBsdf, one a lane: the operations of metal.cpp, dielectric.cpp ... in their order, and so the same
// bits. Each has
//     Lobe(path, wo)     from path.numbers(group), four PackedBsdf::numbers at a time
//     evaluate(wi)       not for deltas; wi and wo are on the same side where no light passes
//     sample(numbers)    drawing numbers.lobe() and numbers.direction() where it needs them

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

struct BsdfValueLanes {
    Vec3Lanes value;
    Floats pdf;
};

struct BsdfSampleLanes {
    Vec3Lanes wi, weight;
    Floats pdf;
    FloatMask there;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
