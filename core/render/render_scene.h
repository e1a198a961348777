#pragma once

#include "core/accel/accelerator.h"
#include "core/lights/light_table.h"
#include "core/render/features.h"
#include "core/scene/scene.h"
#include "core/scene/scene_diff.h"

#include <memory>
#include <optional>
#include <span>

namespace rayuela {

/// What the kernels read, derived from a Scene: flattened objects, packed materials, trees, lights. Immutable; parts that
/// an edit does not touch are shared between versions.
class RenderScene {
public:
    /// Derives `scene`, sharing with `previous` (may be null) what `changes` leaves alone. Null when cancelled.
    static std::shared_ptr<const RenderScene> update(const RenderScene* previous, std::shared_ptr<const Scene> scene,
                                                     const SceneChanges& changes, BuildControl& control);

    const Scene& scene() const { return *scene_; }
    const Features& features() const { return features_; }
    const Accelerator& accelerator() const { return *accelerator_; }
    const LightTable& lights() const { return *lights_; }
    /// The scene object a Hit::object belongs to, and its material.
    ObjectId object_id(std::uint32_t hit_object) const { return (*objects_)[hit_object].id; }
    const Material& material(std::uint32_t hit_object) const { return materials_[(*objects_)[hit_object].material]; }

private:
    struct FlatObject {
        ObjectId id;
        std::uint32_t material;
    };
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const std::vector<FlatObject>> objects_;
    std::vector<Material> materials_;
    std::shared_ptr<const Accelerator> accelerator_;
    std::shared_ptr<const LightTable> lights_;
    Features features_;
};

/// What lies under a point of the image, for picking, focus and read-out.
struct Pick {
    ObjectId object;
    Vec3 point{0};
    Vec3 normal{0};
    float distance = 0;  ///< Along the view axis: what focus_distance means.
};

/// The first thing seen through image position x, y in [0, 1] (0, 0: upper left), through the lens centre.
std::optional<Pick> pick(const RenderScene& scene, const Vec2& position);

}  // namespace rayuela
