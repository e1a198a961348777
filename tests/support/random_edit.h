#pragma once

#include "core/scene/scene_edit.h"

#include <random>

namespace rayuela::testing {

/// A random edit of any kind that the panels can make.
inline SceneEdit random_edit(const Scene& scene, std::mt19937& random) {
    const auto uniform = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
    const auto pick_one = [&](const auto& list) { return list[random() % list.size()]; };
    Camera camera = scene.camera;
    RenderSettings render = scene.render;
    Object object = pick_one(scene.objects);
    MaterialEntry material = pick_one(scene.materials);
    switch (random() % 11) {
        case 0:
            camera.position += Vec3(uniform(-0.2f, 0.2f));
            return SetCamera{camera};
        case 1:
            object.transform.translate.x += uniform(-0.3f, 0.3f);
            return SetObject{object};
        case 2:
            object.visible = !object.visible;
            return SetObject{object};
        case 3:
            object.material = pick_one(scene.materials).id;
            return SetObject{object};
        case 4:
            material.material = pick_one(scene.materials).material;
            return SetMaterial{material};
        case 5:
            render.accel.leaf_size = 1 << (random() % 7);
            return SetRenderSettings{render};
        case 6:
            render.max_bounces = static_cast<int>(random() % 9);
            return SetRenderSettings{render};
        case 7:
            return AddObject{{.shape = Sphere{Vec3(uniform(-2, 2), 0.3f, 2), 0.3f}, .material = material.id}};
        case 8:
            return SetEnvironment{NoEnvironment{}};
        case 9:
            // By powers of two, so that the choice among lamps stays the same to the last bit.
            if (auto* lamp = std::get_if<Emitter>(&material.material))
                lamp->radiance.value *= lamp->radiance.value.x > 8 ? 0.25f : 2.0f;
            return SetMaterial{material};
        default:
            return SetEnvironment{ConstantEnvironment{Color(uniform(0, 1))}};
    }
}

}  // namespace rayuela::testing
