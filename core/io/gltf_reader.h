#pragma once

#include "core/io/image_io.h"
#include "core/materials/material.h"
#include "core/math/result.h"
#include "core/shapes/gltf.h"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayuela {

struct NamedMaterial {
    std::string name;  ///< Not empty; unique within its file.
    Material material;
};

/// A perspective camera of a file, placed in the file's space; it looks along its -z with +y up.
struct NamedCamera {
    std::string name;
    Affine to_file;
    float vfov = 40;  ///< Degrees.
};

/// A glTF file, read. GltfPart::material indexes `materials`. Textures name their place as Image::source:
/// "helmet.glb#2" is image 2 of the file.
struct GltfFile {
    std::shared_ptr<const GltfGeometry> geometry;
    std::vector<NamedMaterial> materials;
    std::vector<NamedCamera> cameras;
    Problems warnings;  ///< What was ignored or repaired.
};

/// Reads the default scene of a .gltf or .glb: triangles, strips and fans, node transforms, cameras, and materials with
/// KHR_materials_{ior, transmission, clearcoat, emissive_strength}. What a file requires and this reader cannot do is an
/// error, what is optional a warning. Files it refers to must lie in its own folder.
Result<std::shared_ptr<const GltfFile>> read_gltf(const std::filesystem::path& path);
/// The same from memory; buffers and images beside `path` are still read from there.
Result<std::shared_ptr<const GltfFile>> parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& path);

/// One image of a file, whether a material uses it or not.
Result<std::shared_ptr<const Image>> read_gltf_image(const std::filesystem::path& path, int index,
                                                     ColorDecoding decoding);

/// Whether the path ends in .gltf or .glb.
bool is_gltf_file(const std::filesystem::path& path);

}  // namespace rayuela
