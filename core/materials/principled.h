#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/ggx_albedo.h"
#include "core/materials/microfacet.h"
#include "core/materials/value.h"
#include "core/math/field.h"

#include <optional>

namespace rayuela {

/// Reflectance of the coat at normal incidence: an index of 1.5, as KHR_materials_clearcoat has it.
inline constexpr float kCoatF0 = 0.04f;

/// A clear coat over GGX facets (Schlick) over a body that scatters light back or lets it through, in proportion to what
/// the layers above leave: a white one reflects and transmits all light. The surface is thin and two-sided: light passes
/// unbent, spread as its reflection would be (KHR_materials_transmission without a volume). Reciprocal but for the coat,
/// which takes its share by wo alone.
struct PrincipledBsdf {
    Ggx facets;
    Color facets_f0{0};   ///< Of dielectric and metal together.
    Color metal_lost{0};  ///< Share of the light lost by the metal's facets that comes out after more bounces.
    float dielectric_f0 = 0;
    Color diffuse{0};
    Color transmission{0};
    float coat = 0;
    Ggx coat_facets;
    GgxAlbedo average;  ///< ggx_average_albedo of `facets`.

    BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const;
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    bool has_smooth_lobe() const;
};

/// glTF 2.0's metallic-roughness material with the KHR extensions that have come so far; names as in glTF.
/// Energy lost between microfacets is given back. Emits from the front.
struct Principled {
    using Bsdf = PrincipledBsdf;

    static constexpr std::string_view kType = "principled", kLabel = "Principled",
                                      kTip = "The glTF material: most things.";

    ColorValue base_color{Color(1), nullptr};
    FloatValue metallic{0, nullptr, 2};
    FloatValue roughness{0.5f, nullptr, 1};
    float ior = 1.5f;
    FloatValue transmission{0, nullptr, 0};
    float clearcoat = 0;
    float clearcoat_roughness = 0;
    ColorValue emissive{Color(0), nullptr};
    float emissive_strength = 1;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.base_color, Field{.key = "base_color",
                                     .label = "Base color",
                                     .tip = "Colour of the body or of the metal.",
                                     .role = FieldRole::reflectance,
                                     .min = 0,
                                     .max = 1});
        visit(self.metallic, Field{.key = "metallic",
                                   .label = "Metallic",
                                   .tip = "0 is plastic, wood, stone; 1 is metal.",
                                   .min = 0,
                                   .max = 1,
                                   .soft_min = 0,
                                   .soft_max = 1});
        visit(self.roughness, Field{.key = "roughness",
                                    .label = "Roughness",
                                    .tip = "0 is polished, 1 is dull.",
                                    .min = 0,
                                    .max = 1,
                                    .soft_min = 0,
                                    .soft_max = 1});
        visit(self.ior, Field{.key = "ior",
                              .label = "Index of refraction",
                              .tip = "Strength of the highlight of what is not metal.",
                              .min = 1,
                              .max = 1000,
                              .soft_min = 1,
                              .soft_max = 2.5f});
        visit(self.transmission, Field{.key = "transmission",
                                       .label = "Transmission",
                                       .tip = "Share of the light that passes through.",
                                       .min = 0,
                                       .max = 1,
                                       .soft_min = 0,
                                       .soft_max = 1});
        visit(self.clearcoat, Field{.key = "clearcoat",
                                    .label = "Clearcoat",
                                    .tip = "Strength of a clear layer on top.",
                                    .min = 0,
                                    .max = 1,
                                    .soft_min = 0,
                                    .soft_max = 1});
        visit(self.clearcoat_roughness, Field{.key = "clearcoat_roughness",
                                              .label = "Clearcoat roughness",
                                              .tip = "Roughness of the clear layer.",
                                              .min = 0,
                                              .max = 1,
                                              .soft_min = 0,
                                              .soft_max = 1});
        visit(self.emissive, Field{.key = "emissive",
                                   .label = "Emissive",
                                   .tip = "Colour of the light the surface gives off.",
                                   .role = FieldRole::radiance,
                                   .min = 0,
                                   .soft_min = 0,
                                   .soft_max = 1});
        visit(self.emissive_strength, Field{.key = "emissive_strength",
                                            .label = "Emissive strength",
                                            .tip = "Multiplies the emissive colour.",
                                            .min = 0,
                                            .soft_min = 0,
                                            .soft_max = 50});
    }
    PrincipledBsdf bsdf(const Vec2& uv) const;
    bool is_specular_only() const;
    bool transmits() const { return !(transmission.value == 0); }
    bool has_delta_lobe() const {
        return is_smooth_everywhere(roughness) || (clearcoat > 0 && alpha_of(clearcoat_roughness) < kSmoothAlpha);
    }
    Emission emission() const { return {emissive, emissive_strength, false}; }
    void put_out() {
        emissive.value = Color(0);
        emissive_strength = 0;
    }
    bool operator==(const Principled&) const = default;
};

}  // namespace rayuela
