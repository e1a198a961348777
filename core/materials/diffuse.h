#pragma once

#include "core/materials/value.h"
#include "core/math/field.h"

namespace rayuela {

/// Lambert, two-sided.
struct Diffuse {
    static constexpr std::string_view kType = "diffuse", kLabel = "Diffuse", kTip = "Matte: scatters light evenly.";

    ColorValue albedo{Color(0.8f), nullptr};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.albedo, Field{.key = "albedo", .label = "Albedo", .tip = "Share of the light that is reflected.",
                                 .role = FieldRole::reflectance, .min = 0, .max = 1});
    }
    bool operator==(const Diffuse&) const = default;
};

}  // namespace rayuela
