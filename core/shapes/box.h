#pragma once

#include "core/math/bounds.h"
#include "core/math/field.h"

namespace rayuela {

/// Axis-aligned in its own space, from corner `min` to corner `max` (min <= max in each axis; may be flat).
struct Box {
    static constexpr std::string_view kType = "box", kLabel = "Box", kTip = "An axis-aligned box between two corners.";

    Vec3 min{-0.5f};
    Vec3 max{0.5f};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.min, Field{"min", "Min corner", "Corner with the smallest coordinates.", FieldRole::position});
        visit(self.max, Field{"max", "Max corner", "Corner with the largest coordinates.", FieldRole::position});
    }
    bool operator==(const Box&) const = default;
};

}  // namespace rayuela
