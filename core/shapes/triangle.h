#pragma once

#include "core/math/field.h"

#include <array>

namespace rayuela {

/// Its front is the side from which the vertices run counter-clockwise.
struct Triangle {
    static constexpr std::string_view kType = "triangle", kLabel = "Triangle", kTip = "One triangle: three vertices.";

    std::array<Vec3, 3> vertices{Vec3(-0.5f, 0, 0), Vec3(0.5f, 0, 0), Vec3(0, 1, 0)};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.vertices,
              Field{"vertices", "Vertices", "Counter-clockwise seen from the front.", FieldRole::position});
    }
    bool operator==(const Triangle&) const = default;
};

}  // namespace rayuela
