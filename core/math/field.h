#pragma once

#include "core/math/ray.h"

#include <string_view>

namespace rayuela {

/// What a field means to a person, where its type alone does not say.
enum class FieldRole : std::uint8_t {
    plain,        ///< A number, a flag, a vector without further meaning.
    position,     ///< A point in the object's space.
    direction,    ///< A vector that must not be zero.
    reflectance,  ///< A colour in [0, 1].
    radiance,     ///< A colour >= 0, may be above 1.
    angle,        ///< Degrees.
    file,         ///< A path, relative to the scene file.
};

/// Describes one member of a shape, material, camera or setting. Every struct lists its members once, in
///     template <typename Self, typename Visitor> static void visit_fields(Self& self, Visitor&& visit)
/// as visit(self.member, Field{...}); the scene file, the panels, the command line and the property tests loop over
/// that list. Self may be const. The default of a field is its value in a default-constructed struct.
struct Field {
    std::string_view key;    ///< As the scene file names it.
    std::string_view label;  ///< As a panel shows it.
    std::string_view tip;    ///< One sentence for the tooltip.
    FieldRole role = FieldRole::plain;
    float min = -kInfinity;
    float max = kInfinity;
    bool min_excluded = false;  ///< The value must be > min rather than >= min.
    float soft_min = 0;         ///< Range of a slider; soft_min == soft_max means a drag field without range.
    float soft_max = 0;
};

}  // namespace rayuela
