#pragma once

#include "core/io/scene_reader.h"
#include "core/render/render_scene.h"
#include "core/scene/scene_edit.h"

#include <cstdlib>
#include <memory>

namespace rayuela {

/// Carries a scene that a reader accepted on to what the kernels read, and traces one ray. An accepted scene that breaks
/// the invariants is a finding.
inline void build_and_trace(const Scene& scene) {
    if (!validate(scene).empty()) std::abort();
    BuildControl control;
    const auto built = RenderScene::update(nullptr, std::make_shared<const Scene>(scene), all_changes(), control);
    if (built) pick(*built, Vec2(0.5f));
}

inline void build_and_trace(const std::shared_ptr<const TriangleMesh>& mesh) {
    Scene scene;
    Object object;
    object.id = ObjectId{scene.next_id++};
    object.name = "mesh";
    object.shape = Mesh{"fuzz.obj", mesh};
    scene.objects.push_back(object);
    build_and_trace(scene);
}

}  // namespace rayuela
