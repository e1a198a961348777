#pragma once

#include "core/io/gltf_reader.h"
#include "core/io/image_io.h"

#include <tiny_gltf.h>

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace rayuela::gltf_internal {

/// A value or the cause of its absence.
template <typename T>
using Expected = tl::expected<T, std::string>;

/// What the parts of the reader share while one file is read.
struct Context {
    const tinygltf::Model& model;
    std::filesystem::path path;
    Problems warnings;
    std::set<std::string> told;

    /// Each cause once, with the first place it was met.
    void warn(const std::string& place, const std::string& cause) {
        if (told.size() < 100 && told.insert(cause).second) warnings.push_back({path.string(), place, cause});
    }
};

/// Elements of `components` floats each; normalized and quantized integers are made floats, sparse ones filled in. All
/// offsets and counts are checked.
Expected<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components);
Expected<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor);
/// The bytes of a buffer view; empty with a cause where it reaches beyond its buffer.
Expected<std::span<const unsigned char>> view_bytes(const tinygltf::Model& model, int view);

/// Turns primitives into meshes; the same accessors give the same mesh.
class PrimitiveReader {
public:
    explicit PrimitiveReader(Context& context) : context_(context) {}

    /// Null with a warning where the primitive has no triangles. `uv_set` is the TEXCOORD that its material uses.
    Expected<std::shared_ptr<const TriangleMesh>> read(const tinygltf::Primitive& primitive, int uv_set,
                                                       const std::string& place);

private:
    using Key = std::tuple<int, int, int, int, int>;
    Expected<std::shared_ptr<const TriangleMesh>> build(const Key& key, const std::string& place);

    Context& context_;
    std::map<Key, std::shared_ptr<const TriangleMesh>> meshes_;
    std::size_t elements_left_ = std::size_t{1} << 27;  ///< Of all meshes together.
};

/// An image of the file; Image::source is its own path, or "helmet.glb#2".
Expected<std::shared_ptr<const Image>> read_image(const Context& context, int index, ColorDecoding decoding);

/// All materials of the file, as Principled; names unique and not empty.
std::vector<NamedMaterial> read_materials(Context& context);
/// The TEXCOORD set that a material's textures use.
int uv_set(Context& context, int material);
/// glTF's default material.
NamedMaterial default_material();

}  // namespace rayuela::gltf_internal
