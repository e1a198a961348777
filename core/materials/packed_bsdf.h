#pragma once

#include "core/materials/material.h"

#include <array>
#include <cstdint>
#include <optional>

namespace rayuela {

/// A Bsdf as its kind and a few numbers: many of a kind can be worked out at once.
struct PackedBsdf {
    enum class Kind : std::uint8_t {
        matte,        ///< DiffuseBsdf.
        facets,       ///< MetalBsdf, rough, one bounce.
        dull,         ///< MetalBsdf, rough, many bounces.
        mirror,       ///< MetalBsdf, smooth.
        glass,        ///< DielectricBsdf, smooth.
        frosted,      ///< DielectricBsdf, rough.
        layered,      ///< PrincipledBsdf of a material that lets no light through; nothing of it is smooth.
        see_through,  ///< The same that does.
    };
    static constexpr Kind kKinds[] = {Kind::matte, Kind::facets,  Kind::dull,    Kind::mirror,
                                      Kind::glass, Kind::frosted, Kind::layered, Kind::see_through};

    Kind kind = Kind::matte;
    /// The Bsdf's own, in the order in which they are unpacked: four by four.
    std::array<float, 20> numbers{};
};

/// Whether Bsdfs of this kind are deltas.
constexpr bool is_delta(PackedBsdf::Kind kind) {
    return kind == PackedBsdf::Kind::mirror || kind == PackedBsdf::Kind::glass;
}

/// As Bsdf's transmits.
constexpr bool transmits(PackedBsdf::Kind kind) {
    using Kind = PackedBsdf::Kind;
    return kind == Kind::glass || kind == Kind::frosted || kind == Kind::see_through;
}

/// The Bsdf of the material at texture coordinates uv, if it is of one of these kinds.
std::optional<PackedBsdf> packed_bsdf(const Material& material, const Vec2& uv);

}  // namespace rayuela
