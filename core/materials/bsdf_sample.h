#pragma once

#include "core/math/vec.h"

#include <optional>

namespace rayuela {

/// What a direction is drawn with, each in [0, 1).
struct ScatterNumbers {
    float lobe;
    Vec2 direction;
};

/// A direction drawn from a Bsdf.
struct BsdfSample {
    Vec3 wi{0};
    Color weight{0};        ///< eval / pdf, cosine included; for a delta lobe the ratio of the two deltas.
    float pdf = 0;          ///< Per solid angle; of a delta lobe: the probability of having chosen it.
    bool specular = false;  ///< From a delta lobe: no light sampling can find it.
    float eta = 1;  ///< Refractive index on the side of wi, relative to that of wo, where a delta lobe bends light.
};

/// Made where it is returned to: a whole that is copied has to wait for its parts to be stored.
inline std::optional<BsdfSample> scattered(const Vec3& wi, const Color& weight, float pdf) {
    std::optional<BsdfSample> sample(std::in_place);
    sample->wi = wi;
    sample->weight = weight;
    sample->pdf = pdf;
    return sample;
}
/// The same from a delta lobe that was chosen with this probability.
inline std::optional<BsdfSample> mirrored(const Vec3& wi, const Color& weight, float probability, float eta = 1) {
    std::optional<BsdfSample> sample = scattered(wi, weight, probability);
    sample->specular = true;
    sample->eta = eta;
    return sample;
}

/// What a Bsdf says about a pair of directions. Delta lobes contribute nothing.
struct BsdfValue {
    Color value{0};  ///< f(wo, wi) * |cos(wi)|.
    float pdf = 0;   ///< Density per solid angle with which wi is drawn.

    BsdfValue() = default;
    BsdfValue(const Color& f, float density) : value(f), pdf(density) {}
    // Not trivial, and so returned in memory: packed into registers it would go through the stack in other pieces than it
    // is made of, which takes longer than what many a Bsdf has to do.
    BsdfValue(const BsdfValue& other) : value(other.value), pdf(other.pdf) {}
    BsdfValue& operator=(const BsdfValue&) = default;
};

}  // namespace rayuela
