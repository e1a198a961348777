#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/microfacet.h"
#include "core/materials/value.h"
#include "core/math/field.h"

#include <optional>

namespace rayuela {

/// A boundary between two media, smooth or of GGX facets (Walter et al., "Microfacet Models for Refraction through Rough
/// Surfaces", EGSR 2007; one bounce, separable Smith masking). wo in z > 0 is outside.
struct DielectricBsdf {
    float ior = 1.5f;
    Color tint{1};
    Ggx ggx;

    BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const;
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    /// False where the lobes are too narrow for directions in float; refraction narrows them by |ior - 1|.
    bool has_smooth_lobe() const {
        return !ggx.is_smooth() && ggx.alpha * std::abs(ior - 1) >= kSmoothAlpha * std::fmin(ior, 1.0f);
    }
};

/// Glass or water: exact Fresnel reflection and refraction. GGX with alpha = roughness^2 when rough.
struct Dielectric {
    using Bsdf = DielectricBsdf;

    static constexpr std::string_view kType = "dielectric", kLabel = "Glass", kTip = "Clear or frosted glass, water.";

    float ior = 1.5f;                    ///< Of the inside, relative to the outside.
    ColorValue tint{Color(1), nullptr};  ///< Multiplies reflected and refracted light alike.
    FloatValue roughness{0, nullptr, 0};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.ior, Field{.key = "ior",
                              .label = "Index of refraction",
                              .tip = "1.33 water, 1.5 glass, 2.4 diamond.",
                              .min = 0,
                              .max = 1000,
                              .min_excluded = true,
                              .soft_min = 1,
                              .soft_max = 2.5f});
        visit(self.tint, Field{.key = "tint",
                               .label = "Tint",
                               .tip = "Colour of the light that passes or is reflected.",
                               .role = FieldRole::reflectance,
                               .min = 0,
                               .max = 1});
        visit(self.roughness, Field{.key = "roughness",
                                    .label = "Roughness",
                                    .tip = "0 is clear, 1 is frosted.",
                                    .min = 0,
                                    .max = 1,
                                    .soft_min = 0,
                                    .soft_max = 1});
    }
    DielectricBsdf bsdf(const Vec2& uv) const;
    bool is_specular_only() const { return is_smooth_everywhere(roughness); }
    bool transmits() const { return true; }
    bool has_delta_lobe() const { return is_smooth_everywhere(roughness); }
    bool operator==(const Dielectric&) const = default;
};

}  // namespace rayuela
