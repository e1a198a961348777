#pragma once

#include "core/math/bounds.h"
#include "core/math/field.h"

namespace rayuela {

struct Sphere {
    static constexpr std::string_view kType = "sphere", kLabel = "Sphere", kTip = "A ball: centre and radius.";

    Vec3 center{0};
    float radius = 1;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.center, Field{"center", "Center", "Centre of the sphere.", FieldRole::position});
        visit(self.radius, Field{.key = "radius",
                                 .label = "Radius",
                                 .tip = "Distance from the centre to the surface.",
                                 .min = 0,
                                 .min_excluded = true});
    }
    bool operator==(const Sphere&) const = default;
};

}  // namespace rayuela
