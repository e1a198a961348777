#pragma once

#include "core/io/asset_cache.h"
#include "core/math/result.h"
#include "core/scene/scene.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rayuela {

struct LoadedScene {
    Scene scene;
    Problems warnings;
};

/// Opens a .scene.json (any .json), .gltf, .glb, .obj or .ply. Around one of the latter four a scene is made: a camera
/// (the file's, or one that frames its bounds), a sky, a material. Paths within the scene (Mesh::file, Image::source...)
/// are absolute from then on, so that the scene can be saved anywhere.
/// Every error of a scene file is listed, with its JSON path.
Result<LoadedScene> read_scene(const std::filesystem::path& path, AssetCache* cache = nullptr);

/// A scene file from memory. Relative paths are relative to `base`; `name` stands in messages.
Result<LoadedScene> scene_from_json(std::string_view text, const std::filesystem::path& base, const std::string& name,
                                    AssetCache* cache = nullptr);

/// One object from a .obj, .ply, .gltf or .glb, to be added to a scene.
struct LoadedObject {
    Object object;                         ///< Named after the file.
    std::vector<NamedMaterial> materials;  ///< A glTF file's own; GltfPart::material indexes them.
    Problems warnings;
};
Result<LoadedObject> load_object_file(const std::filesystem::path& path, AssetCache* cache = nullptr);

/// The scene with the object and its materials: one step of history. The object gets id next_id of the result of adding the
/// materials, and stands last. Materials that the scene has by that name already are used, not added.
Result<Scene> add_to_scene(const Scene& scene, const LoadedObject& loaded);

/// Whether `read_scene` knows the extension of this path.
bool is_scene_file(const std::filesystem::path& path);

/// A camera from which the bounds fill an image of this aspect (width / height), seen from above and to the right.
Camera frame_bounds(const Bounds3& bounds, float vfov, float aspect);

}  // namespace rayuela
