#pragma once

#include "core/math/field.h"

namespace rayuela {

/// Thin-lens camera; image right is forward x up. The focus plane is perpendicular to the view axis.
struct Camera {
    Vec3 position{0, 1, 5};
    Vec3 target{0, 1, 0};
    Vec3 up{0, 1, 0};
    float vfov = 40;
    float lens_radius = 0;
    float focus_distance = 5;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.position, Field{"position", "Position", "Where the eye is.", FieldRole::position});
        visit(self.target, Field{"target", "Target", "The point looked at and orbited around.", FieldRole::position});
        visit(self.up, Field{"up", "Up", "Direction that is up in the image.", FieldRole::direction});
        visit(self.vfov, Field{.key = "vfov",
                               .label = "Field of view",
                               .tip = "Vertical opening angle, degrees.",
                               .role = FieldRole::angle,
                               .min = 0.01f,
                               .max = 179.9f,
                               .soft_min = 5,
                               .soft_max = 120});
        visit(self.lens_radius, Field{.key = "lens_radius",
                                      .label = "Lens radius",
                                      .tip = "0 is a pinhole; larger blurs what is out of focus.",
                                      .min = 0});
        visit(self.focus_distance, Field{.key = "focus_distance",
                                         .label = "Focus distance",
                                         .tip = "Distance of the sharp plane along the view axis.",
                                         .min = 0,
                                         .min_excluded = true});
    }
    bool operator==(const Camera&) const = default;
};

}  // namespace rayuela
