#pragma once

#include "core/accel/accel_settings.h"
#include "core/materials/material.h"
#include "core/math/id.h"
#include "core/math/sampler.h"
#include "core/math/transform.h"
#include "core/scene/camera.h"
#include "core/scene/environment.h"
#include "core/scene/light_choice.h"
#include "core/shapes/shape.h"

#include <optional>
#include <string>
#include <vector>

namespace rayuela {

struct Object {
    ObjectId id;
    ObjectId parent;  ///< An ObjectList, or none.
    std::string name;
    Shape shape;
    Transform transform;  ///< To the parent's space.
    MaterialId material;  ///< None: kDefaultMaterial, or a glTF file's own.
    bool visible = true;

    bool operator==(const Object&) const = default;
};

struct MaterialEntry {
    MaterialId id;
    std::string name;  ///< Unique and not empty.
    Material material;

    bool operator==(const MaterialEntry&) const = default;
};

enum class PixelFilter : std::uint8_t { box, tent, gaussian };

inline constexpr int kMaxFilmSide = 16384;

struct FilmSettings {
    int width = 1280, height = 720;  ///< In [1, kMaxFilmSide].
    PixelFilter filter = PixelFilter::box;

    bool operator==(const FilmSettings&) const = default;
};

struct RenderSettings {
    int max_bounces = 8;          ///< Scattering events; 0 shows emitters and environment only.
    std::optional<int> rr_start;  ///< First bounce that Russian roulette may cut; empty: the renderer's choice.
    AccelSettings accel;
    SamplerKind sampler = SamplerKind::sobol;
    LightChoice light_choice = LightChoice::arriving;
    std::uint32_t seed = 0;
    int max_samples = 0;     ///< Stop at so many samples a pixel; 0 never.
    double max_seconds = 0;  ///< Stop after so much rendering; 0 never.

    bool operator==(const RenderSettings&) const = default;
};

/// Everything that can be edited, as plain values; heavy data is shared and immutable. Copying is cheap.
/// Invariants (kept by `apply` and by the scene file reader): ids are unique and below next_id; parents exist, are
/// ObjectLists and form no cycle; materials referred to exist; every number lies in the range its Field gives.
struct Scene {
    FilmSettings film;
    Camera camera;
    Environment environment;
    std::vector<MaterialEntry> materials;
    std::vector<Object> objects;  ///< Parents before their children.
    RenderSettings render;
    std::uint32_t next_id = 1;  ///< Objects and materials draw their ids from here.

    const Object* find(ObjectId id) const;
    const MaterialEntry* find(MaterialId id) const;
    const MaterialEntry* find_material(std::string_view name) const;
    /// Product of the transforms from the object up to the root.
    Affine to_world(ObjectId id) const;
    /// Visible itself and all its parents.
    bool is_visible(ObjectId id) const;
    bool operator==(const Scene&) const = default;
};

/// Of an object without a material.
inline const Material kDefaultMaterial = Diffuse{};

/// World bounds of an object and its children; empty for planes and empty lists.
Bounds3 world_bounds(const Scene& scene, ObjectId id);
/// World bounds of all visible objects but the planes.
Bounds3 world_bounds(const Scene& scene);

}  // namespace rayuela
