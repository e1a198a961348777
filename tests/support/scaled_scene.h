#pragma once

#include "core/scene/scene.h"

namespace rayuela::testing {

/// The scene in another unit of length.
inline Scene scaled_by(Scene scene, float factor) {
    scene.camera.position *= factor;
    scene.camera.target *= factor;
    scene.camera.focus_distance *= factor;
    scene.camera.lens_radius *= factor;
    for (Object& object : scene.objects) {
        object.transform.translate *= factor;
        object.transform.scale *= factor;
    }
    return scene;
}

}  // namespace rayuela::testing
