#pragma once

#include "core/materials/value.h"
#include "core/math/field.h"

namespace rayuela {

/// Emits from the front (outside) and reflects nothing.
struct Emitter {
    static constexpr std::string_view kType = "emitter", kLabel = "Emitter", kTip = "A light source.";

    ColorValue radiance{Color(5), nullptr};
    bool two_sided = false;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.radiance, Field{.key = "radiance", .label = "Radiance", .tip = "Light that leaves the surface.",
                                   .role = FieldRole::radiance, .min = 0, .soft_min = 0, .soft_max = 50});
        visit(self.two_sided, Field{"two_sided", "Two-sided", "Emit from the back as well."});
    }
    bool operator==(const Emitter&) const = default;
};

}  // namespace rayuela
