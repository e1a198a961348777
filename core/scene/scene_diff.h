#pragma once

#include "core/scene/scene.h"

#include <optional>

namespace rayuela {

/// What differs between two scenes, by what has to be rebuilt for it. Derived by `diff`, never set by hand.
struct SceneChanges {
    bool film_size = false;  ///< A new film.
    bool camera = false;     ///< Nothing is rebuilt.
    bool sampling = false;   ///< Bounces, roulette, sampler, seed, filter: nothing is rebuilt.
    bool materials = false;  ///< Packed materials; lights where what emits changed.
    bool geometry =
        false;  ///< Shapes, transforms, visibility, objects added or removed: the top level; lights as above.
    bool assignment = false;   ///< An object's material; lights as above.
    bool environment = false;  ///< Its distribution.
    bool accel = false;        ///< Trees; the image does not depend on them, so accumulation goes on.
    /// What `materials` and `environment` mean to the image, where they mean no more: see light_factor.
    std::optional<Vec3d> light;

    /// Whether what has been accumulated is of no use any more, not even multiplied by `light`.
    bool restarts() const {
        return film_size || camera || sampling || geometry || assignment || ((materials || environment) && !light);
    }
    bool any() const { return restarts() || materials || environment || accel; }
    bool operator==(const SceneChanges&) const = default;
};

SceneChanges diff(const Scene& before, const Scene& after);
/// What a first scene changes: everything.
SceneChanges all_changes();

}  // namespace rayuela
