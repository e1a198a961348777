#include "core/io/gltf_names.h"

#include "core/scene/validate.h"

#include <algorithm>

namespace rayuela {

GltfNames::GltfNames(const Scene& scene) {
    for (const Object& object : scene.objects) {
        if (const auto* gltf = std::get_if<Gltf>(&object.shape)) prefix(gltf->file);
    }
}

std::string GltfNames::prefix(const std::string& file) {
    const auto known = prefixes_.find(file);
    if (known != prefixes_.end()) return known->second;
    const auto is_taken = [&](const std::string& stem) {
        return std::ranges::any_of(prefixes_, [&](const auto& entry) { return entry.second == stem + "/"; });
    };
    return prefixes_[file] = unique_name(std::filesystem::path(file).stem().string(), is_taken) + "/";
}

}  // namespace rayuela
