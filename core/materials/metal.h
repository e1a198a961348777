#pragma once

#include "core/materials/value.h"
#include "core/math/field.h"

namespace rayuela {

/// A conductor with the same reflectance at all angles. GGX with alpha = roughness^2; a perfect mirror at roughness 0.
struct Metal {
    static constexpr std::string_view kType = "metal", kLabel = "Metal", kTip = "Mirror to brushed metal.";

    ColorValue albedo{Color(0.9f), nullptr};
    FloatValue roughness{0, nullptr, 0};
    bool multiscatter = false;  ///< Height-correlated masking with the energy lost to it given back.

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.albedo, Field{.key = "albedo", .label = "Albedo", .tip = "Colour of the reflection.",
                                 .role = FieldRole::reflectance, .min = 0, .max = 1});
        visit(self.roughness, Field{.key = "roughness", .label = "Roughness", .tip = "0 is a mirror, 1 is dull.",
                                    .min = 0, .max = 1, .soft_min = 0, .soft_max = 1});
        visit(self.multiscatter, Field{"multiscatter", "Multiple scattering",
                                       "Give back the light that bounces more than once between the facets."});
    }
    bool operator==(const Metal&) const = default;
};

}  // namespace rayuela
