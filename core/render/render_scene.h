#pragma once

#include "core/accel/accelerator.h"
#include "core/accel/surface_point.h"
#include "core/lights/environment_light.h"
#include "core/lights/light_emission.h"
#include "core/lights/light_table.h"
#include "core/materials/bsdf.h"
#include "core/materials/packed_bsdf.h"
#include "core/math/result.h"
#include "core/render/features.h"
#include "core/render/shortcuts.h"
#include "core/scene/scene.h"
#include "core/scene/scene_diff.h"

#include <memory>
#include <optional>
#include <span>

namespace rayuela {

/// A material as the shading loop wants it: what does not vary over the surface is worked out once.
struct PackedMaterial {
    Material material;
    Bsdf bsdf;              ///< Where `textured` is false.
    bool textured = false;  ///< The Bsdf and the emission vary over the surface.
    bool emissive = false;
    bool smooth = true;  ///< Light samples can contribute.
    bool transmits = false;
    bool delta = false;  ///< Has a delta lobe.
    std::optional<PackedBsdf>
        packed;  ///< Where it is one and emits nothing; at texture coordinates 0 where `textured`.
};

/// What the kernels read, derived from a Scene: flattened objects, packed materials, trees, lights. Immutable; parts that
/// an edit does not touch are shared between versions.
class RenderScene {
public:
    /// Derives `scene`, sharing with `previous` (may be null) what `changes` leaves alone. Null when cancelled. Heeds
    /// Shortcuts::few_objects wherever trees are built. `draft`: drafts of trees will do.
    static std::shared_ptr<const RenderScene> update(const RenderScene* previous, std::shared_ptr<const Scene> scene,
                                                     const SceneChanges& changes, BuildControl& control,
                                                     const Shortcuts& shortcuts = {}, bool draft = false);
    /// Whether some of the trees are drafts.
    bool has_drafts() const { return accelerator_->settings().draft; }
    /// The same objects in the trees they were meant to have. Null when cancelled.
    std::shared_ptr<const Accelerator> without_drafts(BuildControl& control) const;
    /// This with the trees of `known` for the meshes that are there; those of other meshes stay.
    std::shared_ptr<const RenderScene> with_trees(const Accelerator& known) const;

    const Scene& scene() const { return *scene_; }
    /// Rays are traced in a space with the axes of the scene whose origin is here: next to the objects where those are far
    /// from the scene's own, so that no digits are lost on the way to them. All that follows is in that space.
    const Vec3& origin() const { return origin_; }
    /// The scene's camera, there.
    Camera camera() const;
    const std::shared_ptr<const Scene>& shared_scene() const { return scene_; }
    const Features& features() const { return features_; }
    const Accelerator& accelerator() const { return *accelerator_; }
    const Surfaces& surfaces() const { return *surfaces_; }
    const LightTable& lights() const { return *lights_; }
    /// Rays from the lamps towards mirrors and glass; null where there are none of either.
    const LightEmission* emission() const { return emission_.get(); }
    const EnvironmentLight& environment() const { return environment_; }
    /// The scene object a Hit::object belongs to, and its material.
    ObjectId object_id(std::uint32_t hit_object) const { return (*objects_)[hit_object].id; }
    const PackedMaterial& packed_material(std::uint32_t hit_object) const {
        return (*materials_)[(*objects_)[hit_object].material];
    }
    const Material& material(std::uint32_t hit_object) const { return packed_material(hit_object).material; }
    /// Trees, lights, meshes and images, each counted once.
    std::uint64_t memory_bytes() const;
    /// What is missing though its file was there when it was opened; shown without it.
    const Problems& problems() const { return problems_; }

private:
    struct FlatObject {
        ObjectId id;
        std::uint32_t material;
    };
    using FlatObjects = std::vector<FlatObject>;
    using PackedMaterials = std::vector<PackedMaterial>;

    std::shared_ptr<const Accelerator> rebuilt(const AccelSettings& settings, const Accelerator* better,
                                               BuildControl& control) const;
    void flatten(std::vector<GeometryInstance>& instances, FlatObjects& objects) const;
    void pack_materials();
    void find_surfaces();
    std::vector<bool> used_materials() const;
    std::vector<std::uint8_t> textured_objects() const;
    bool update_lights(const RenderScene* previous);
    void update_emission(const RenderScene* previous, bool same_lights);
    std::vector<std::uint32_t> objects_with(bool PackedMaterial::*property) const;
    bool same_lamps(const RenderScene& other) const;
    bool same_targets(const RenderScene& other) const;
    Features find_features() const;
    std::shared_ptr<const LightEmission> find_emission() const;

    std::shared_ptr<const Scene> scene_;
    Vec3 origin_{0};
    std::shared_ptr<const FlatObjects> objects_;
    /// The default material, then the scene's. Images of those that no visible object has may be without pixels.
    std::shared_ptr<const PackedMaterials> materials_;
    std::shared_ptr<const Accelerator> accelerator_;
    std::shared_ptr<const Surfaces> surfaces_;
    std::shared_ptr<const LightTable> lights_;
    std::shared_ptr<const LightEmission> emission_;
    EnvironmentLight environment_;
    Features features_;
    Problems problems_;
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
