#pragma once

#include "core/io/asset_cache.h"
#include "core/math/result.h"
#include "core/scene/scene.h"

#include <filesystem>
#include <string>

namespace rayuela {

/// Saves a scene so that `read_scene` gives it back: every number to the same bits, keys at their default left out, paths
/// relative to the file, materials left out where they equal those of the glTF file they came from. The file appears
/// whole or not at all. A mesh or texture that came from no file is an error.
Result<void> write_scene(const std::filesystem::path& path, const Scene& scene, AssetCache* cache = nullptr);

/// The text that write_scene writes, with paths relative to `base`.
Result<std::string> scene_to_json(const Scene& scene, const std::filesystem::path& base, AssetCache* cache = nullptr);

}  // namespace rayuela
