#pragma once

#include "core/io/gltf_reader.h"
#include "core/scene/scene.h"

#include <map>
#include <string>

namespace rayuela {

/// How the materials of glTF files are called in a scene: "<stem>/<name>", or "<stem> 2/<name>" for a second file of the
/// same stem. The reader, the writer and "add to scene" share this rule, so that a saved scene finds them again.
class GltfNames {
public:
    GltfNames() = default;
    /// Knows the files of the scene's objects, in their order.
    explicit GltfNames(const Scene& scene);

    /// The prefix of a file, "helmet/"; a new file gets the next free one.
    std::string prefix(const std::string& file);

private:
    std::map<std::string, std::string> prefixes_;  ///< By file.
};

}  // namespace rayuela
