#pragma once

#include "core/math/field.h"

namespace rayuela {

/// Parallelogram point, point + u, point + u + v, point + v. Its front is the side of u x v.
struct Quad {
    static constexpr std::string_view kType = "quad", kLabel = "Quad",
                                      kTip = "A parallelogram: a corner and two edges.";

    Vec3 point{-0.5f, 0, 0.5f};
    Vec3 u{1, 0, 0};
    Vec3 v{0, 0, -1};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.point, Field{"point", "Corner", "The corner from which both edges start.", FieldRole::position});
        visit(self.u, Field{"u", "Edge u", "First edge.", FieldRole::direction});
        visit(self.v, Field{"v", "Edge v", "Second edge; the front is u x v.", FieldRole::direction});
    }
    bool operator==(const Quad&) const = default;
};

}  // namespace rayuela
