#pragma once

#include "core/materials/material.h"

#include <cstdint>
#include <optional>

namespace rayuela {

/// A Bsdf of one kind of lobe and few numbers: many points can be shaded by lobes of a kind at once.
struct SingleLobe {
    enum class Kind : std::uint8_t {
        matte,   ///< DiffuseBsdf.
        facets,  ///< MetalBsdf, rough, one bounce.
        mirror,  ///< MetalBsdf, smooth.
        glass,   ///< DielectricBsdf, smooth.
    };
    static constexpr Kind kKinds[] = {Kind::matte, Kind::facets, Kind::mirror, Kind::glass};

    Kind kind = Kind::matte;
    Color color{0};
    float shape = 0;  ///< Alpha of facets; refractive index of glass.
};

/// Whether lobes of this kind are deltas.
constexpr bool is_delta(SingleLobe::Kind kind) {
    return kind == SingleLobe::Kind::mirror || kind == SingleLobe::Kind::glass;
}

/// What the Bsdf of the material at texture coordinates uv is, if it is so plain.
std::optional<SingleLobe> single_lobe(const Material& material, const Vec2& uv);

}  // namespace rayuela
