#include "core/io/asset_cache.h"

#include <charconv>

namespace rayuela {

namespace fs = std::filesystem;

namespace {

/// "folder/helmet.glb#2" -> the file and 2, where no file has the whole name.
std::optional<std::pair<fs::path, int>> embedded_image(const fs::path& path) {
    const std::string name = path.string();
    const std::size_t hash = name.rfind('#');
    std::error_code error;
    if (hash == std::string::npos || fs::exists(path, error)) return std::nullopt;
    int index = 0;
    const char* const last = name.data() + name.size();
    const auto [end, bad] = std::from_chars(name.data() + hash + 1, last, index);
    fs::path file = name.substr(0, hash);
    if (bad != std::errc() || end != last || !is_gltf_file(file)) return std::nullopt;
    return std::pair(std::move(file), index);
}

/// Light is neither negative, infinite nor undefined; a panorama with such pixels is repaired.
std::shared_ptr<const Image> repaired(const std::shared_ptr<const Image>& image, Problems& warnings) {
    const auto is_good = [](float value) { return value >= 0 && value < kInfinity; };
    std::size_t bad = 0;
    for (const Vec4& pixel : image->pixels)
        bad += !(is_good(pixel.x) && is_good(pixel.y) && is_good(pixel.z) && is_good(pixel.w));
    if (bad == 0) return image;
    auto copy = std::make_shared<Image>(*image);
    constexpr float kLargestHalf = 65504;
    for (Vec4& pixel : copy->pixels) {
        for (int channel = 0; channel < 4; ++channel) {
            if (is_good(pixel[channel])) continue;
            pixel[channel] = pixel[channel] == kInfinity ? kLargestHalf : 0;
        }
    }
    warnings.push_back({image->source, "", std::to_string(bad) + " pixels are negative or not finite: repaired"});
    return copy;
}

template <typename T>
void erase_unused(T& entries) {
    std::erase_if(entries, [](const auto& entry) { return entry.second.data.use_count() == 1; });
}

}  // namespace

template <typename T>
Result<std::shared_ptr<const T>> AssetCache::fetch(
    Entries<T>& entries, const fs::path& file, const std::string& key, Problems* warnings,
    const std::function<Result<std::shared_ptr<const T>>(Problems&)>& read) {
    std::error_code error;
    const fs::file_time_type time = fs::last_write_time(file, error);
    const auto tell = [&](const Problems& told) {
        if (warnings) warnings->insert(warnings->end(), told.begin(), told.end());
    };
    {
        const std::lock_guard lock(mutex_);
        const auto known = entries.find(key);
        if (known != entries.end() && known->second.time == time) {
            tell(known->second.warnings);
            return known->second.data;
        }
    }
    Problems told;
    auto data = read(told);
    if (!data) return data;
    tell(told);
    const std::lock_guard lock(mutex_);
    entries[key] = {time, *data, std::move(told)};
    return data;
}

MeshResult AssetCache::mesh(const fs::path& path, Problems* warnings) {
    return fetch<TriangleMesh>(meshes_, path, path.string(), warnings,
                               [&](Problems& told) { return read_mesh(path, &told); });
}

Result<std::shared_ptr<const Image>> AssetCache::image(const fs::path& path, ColorDecoding decoding,
                                                       Problems* warnings) {
    const auto embedded = embedded_image(path);
    const std::string key = path.string() + (decoding == ColorDecoding::srgb ? "|srgb" : "|linear");
    return fetch<Image>(images_, embedded ? embedded->first : path, key, warnings,
                        [&](Problems& told) -> Result<std::shared_ptr<const Image>> {
                            auto image = embedded ? read_gltf_image(embedded->first, embedded->second, decoding)
                                                  : open_image(path, decoding);
                            if (!image) return image;
                            return repaired(*image, told);
                        });
}

Result<std::shared_ptr<const Image>> AssetCache::panorama(const fs::path& path, ColorDecoding decoding,
                                                          Problems* warnings) {
    const auto opened = image(path, decoding, warnings);
    if (!opened) return opened;
    if (auto seen = with_pixels(*opened)) return seen;
    return fail(path.string(), "", "cannot be decoded");
}

Result<std::shared_ptr<const GltfFile>> AssetCache::gltf(const fs::path& path) {
    return fetch<GltfFile>(gltfs_, path, path.string(), nullptr, [&](Problems&) { return read_gltf(path); });
}

void AssetCache::release_unused() {
    const std::lock_guard lock(mutex_);
    erase_unused(meshes_);
    std::erase_if(gltfs_, [](const auto& entry) { return entry.second.data->geometry.use_count() == 1; });
    erase_unused(images_);
}

}  // namespace rayuela
