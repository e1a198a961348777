#pragma once

#include "core/math/field.h"

namespace rayuela {

/// Groups the objects whose `parent` it is: they move, hide and vanish with it. In a scene file its children stand under
/// the key "objects".
struct ObjectList {
    static constexpr std::string_view kType = "list", kLabel = "Object list",
                                      kTip = "A group: its members move with it.";

    template <typename Self, typename Visitor>
    static void visit_fields(Self&, Visitor&&) {}
    bool operator==(const ObjectList&) const = default;
};

}  // namespace rayuela
