#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/microfacet.h"
#include "core/materials/value.h"
#include "core/math/field.h"

#include <optional>

namespace rayuela {

/// GGX facets of constant reflectance, on the side that wo is on.
struct MetalBsdf {
    Color reflectance{0};
    Ggx ggx;
    bool multiscatter = false;
    Color lost_reflectance{0};  ///< Of the light that leaves after more than one bounce, over what a bounce loses.
    float average_albedo = 1;   ///< ggx_average_albedo, where `multiscatter`.

    BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const;
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    bool has_smooth_lobe() const { return !ggx.is_smooth(); }
};

/// A conductor with the same reflectance at all angles. GGX with alpha = roughness^2; a perfect mirror at roughness 0.
struct Metal {
    using Bsdf = MetalBsdf;

    static constexpr std::string_view kType = "metal", kLabel = "Metal", kTip = "Mirror to brushed metal.";

    ColorValue albedo{Color(0.9f), nullptr};
    FloatValue roughness{0, nullptr, 0};
    bool multiscatter = false;  ///< Height-correlated masking with the energy lost to it given back.

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.albedo, Field{.key = "albedo",
                                 .label = "Albedo",
                                 .tip = "Colour of the reflection.",
                                 .role = FieldRole::reflectance,
                                 .min = 0,
                                 .max = 1});
        visit(self.roughness, Field{.key = "roughness",
                                    .label = "Roughness",
                                    .tip = "0 is a mirror, 1 is dull.",
                                    .min = 0,
                                    .max = 1,
                                    .soft_min = 0,
                                    .soft_max = 1});
        visit(self.multiscatter, Field{"multiscatter", "Multiple scattering",
                                       "Give back the light that bounces more than once between the facets."});
    }
    MetalBsdf bsdf(const Vec2& uv) const;
    bool is_specular_only() const { return is_smooth_everywhere(roughness); }
    bool transmits() const { return false; }
    bool has_delta_lobe() const { return is_smooth_everywhere(roughness); }
    bool operator==(const Metal&) const = default;
};

}  // namespace rayuela
