#pragma once

#include "core/io/gltf_reader.h"
#include "core/io/scene_reader.h"
#include "core/render/render_scene.h"
#include "core/scene/scene_edit.h"

#include <memory>

/// Carry what a reader accepted on to what the kernels read, and trace one ray. False where it breaks the invariants of
/// scenes; sanitizers watch the rest.
namespace rayuela::testing {

inline bool can_be_shown(const Scene& scene) {
    if (!validate(scene).empty()) return false;
    BuildControl control;
    const auto built = RenderScene::update(nullptr, std::make_shared<const Scene>(scene), all_changes(), control);
    if (built) (void)pick(*built, Vec2(0.5f));
    return true;
}

inline bool can_be_shown(const std::shared_ptr<const TriangleMesh>& mesh) {
    Scene scene;
    Object object;
    object.id = ObjectId{scene.next_id++};
    object.name = "mesh";
    object.shape = Mesh{"mesh.obj", mesh};
    scene.objects.push_back(object);
    return can_be_shown(scene);
}

inline bool can_be_shown(const GltfFile& file) {
    LoadedObject loaded;
    loaded.object.shape = Gltf{"/nowhere/file.glb", file.geometry, {}};
    loaded.materials = file.materials;
    const auto scene = add_to_scene(Scene{}, loaded);
    return scene && can_be_shown(*scene);
}

}  // namespace rayuela::testing
