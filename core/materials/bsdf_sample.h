#pragma once

#include "core/math/vec.h"

namespace rayuela {

/// A direction drawn from a Bsdf.
struct BsdfSample {
    Vec3 wi{0};
    Color weight{0};        ///< eval / pdf, cosine included; for a delta lobe the ratio of the two deltas.
    float pdf = 0;          ///< Per solid angle; of a delta lobe: the probability of having chosen it.
    bool specular = false;  ///< From a delta lobe: no light sampling can find it.
    float eta = 1;  ///< Refractive index on the side of wi, relative to that of wo, where a delta lobe bends light.
};

/// What a Bsdf says about a pair of directions. Delta lobes contribute nothing.
struct BsdfValue {
    Color value{0};  ///< f(wo, wi) * |cos(wi)|.
    float pdf = 0;   ///< Density per solid angle with which wi is drawn.
};

}  // namespace rayuela
