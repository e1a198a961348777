#pragma once

#include "core/math/field.h"

namespace rayuela {

/// Infinite plane through `point`.
struct Plane {
    static constexpr std::string_view kType = "plane", kLabel = "Plane",
                                      kTip = "An infinite plane: a point and a normal.";

    Vec3 point{0};
    Vec3 normal{0, 1, 0};  ///< Any length but zero.

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.point, Field{"point", "Point", "Any point of the plane.", FieldRole::position});
        visit(self.normal, Field{"normal", "Normal", "Direction in which the plane faces.", FieldRole::direction});
    }
    bool operator==(const Plane&) const = default;
};

}  // namespace rayuela
