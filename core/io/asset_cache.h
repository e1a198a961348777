#pragma once

#include "core/io/gltf_reader.h"
#include "core/io/image_io.h"
#include "core/io/mesh_io.h"

#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace rayuela {

/// Meshes, images and glTF files by absolute path and time of last change: what several objects name, or what is
/// opened again, is read once and shared. Safe to use from several threads.
class AssetCache {
public:
    MeshResult mesh(const std::filesystem::path& path, Problems* warnings = nullptr);
    /// "folder/helmet.glb#2" names image 2 of a glTF file. May have no pixels yet: see `open_image`.
    Result<std::shared_ptr<const Image>> image(const std::filesystem::path& path, ColorDecoding decoding,
                                               Problems* warnings = nullptr);
    /// The same for what is seen at once: it has its pixels.
    Result<std::shared_ptr<const Image>> panorama(const std::filesystem::path& path, ColorDecoding decoding,
                                                  Problems* warnings = nullptr);
    Result<std::shared_ptr<const GltfFile>> gltf(const std::filesystem::path& path);
    /// Forgets what nobody else holds any more.
    void release_unused();

private:
    template <typename T>
    struct Entry {
        std::filesystem::file_time_type time;
        std::shared_ptr<const T> data;
        Problems warnings;
    };
    template <typename T>
    using Entries = std::map<std::string, Entry<T>>;
    template <typename T>
    Result<std::shared_ptr<const T>> fetch(Entries<T>& entries, const std::filesystem::path& file,
                                           const std::string& key, Problems* warnings,
                                           const std::function<Result<std::shared_ptr<const T>>(Problems&)>& read);

    std::mutex mutex_;
    Entries<TriangleMesh> meshes_;
    Entries<Image> images_;
    Entries<GltfFile> gltfs_;
};

}  // namespace rayuela
