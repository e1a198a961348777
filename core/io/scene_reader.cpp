#include "core/io/scene_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/gltf_names.h"
#include "core/io/scene_parser.h"
#include "core/materials/bsdf.h"
#include "core/scene/scene_edit.h"
#include "core/scene/validate.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 5> kExtensions{".json", ".gltf", ".glb", ".obj", ".ply"};

fs::path absolute_path(const fs::path& path) {
    std::error_code error;
    fs::path result = fs::absolute(path, error);
    return (error ? path : result).lexically_normal();
}

/// A file's camera; it looks at what lies before it at the distance of the scene's middle.
Camera place_camera(const NamedCamera& from, const Affine& to_world, const Bounds3& bounds) {
    const Affine to_scene = to_world * from.to_file;
    Camera camera;
    camera.position = to_scene.translation;
    const Vec3 forward = glm::normalize(to_scene.vector({0, 0, -1}));
    const float distance = bounds.empty() ? 1 : glm::dot(bounds.center() - camera.position, forward);
    camera.focus_distance = distance > 0 && std::isfinite(distance) ? distance : 1;
    camera.target = camera.position + camera.focus_distance * forward;
    camera.up = glm::normalize(to_scene.vector({0, 1, 0}));
    camera.vfov = from.vfov;
    return camera;
}

/// The scene around a file that is only an object.
Result<LoadedScene> scene_around(const fs::path& path, AssetCache& cache) {
    Result<LoadedObject> loaded = load_object_file(path, &cache);
    if (!loaded) return tl::unexpected(std::move(loaded.error()));
    Scene empty;
    auto* const mesh = std::get_if<Mesh>(&loaded->object.shape);
    if (mesh) {
        empty.materials.push_back({MaterialId{empty.next_id++}, loaded->object.name, kDefaultMaterial});
        loaded->object.material = empty.materials.front().id;
    }
    Result<Scene> scene = add_to_scene(empty, *loaded);
    if (!scene) return tl::unexpected(std::move(scene.error()));

    const bool has_lights =
        std::ranges::any_of(scene->materials, [](const MaterialEntry& entry) { return is_emissive(entry.material); });
    GradientEnvironment sky;
    if (has_lights) {
        sky.bottom *= 0.25f;
        sky.top *= 0.25f;
    }
    scene->environment = sky;
    const float aspect = static_cast<float>(scene->film.width) / static_cast<float>(scene->film.height);
    const Bounds3 bounds = world_bounds(*scene);
    scene->camera = frame_bounds(bounds, Camera{}.vfov, aspect);
    if (!mesh) {
        const auto file = cache.gltf(std::get<Gltf>(loaded->object.shape).file);
        if (file && !(*file)->cameras.empty()) scene->camera = place_camera((*file)->cameras.front(), Affine{}, bounds);
    }
    if (Problems problems = validate(*scene); !problems.empty()) {
        for (Problem& problem : problems) problem.file = path.string();
        return tl::unexpected(std::move(problems));
    }
    return LoadedScene{std::move(*scene), std::move(loaded->warnings)};
}

}  // namespace

Result<LoadedScene> read_scene(const fs::path& path, AssetCache* cache) {
    AssetCache own;
    AssetCache& assets = cache ? *cache : own;
    if (is_mesh_file(path) || is_gltf_file(path)) return scene_around(path, assets);
    if (!is_scene_file(path)) {
        return fail(
            path.string(), "",
            "unknown extension '" + path.extension().string() + "'; scenes are .scene.json, .gltf, .glb, .obj or .ply");
    }
    const Result<std::string> text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    return scene_from_json(*text, absolute_path(path).parent_path(), path.string(), &assets);
}

Result<LoadedScene> scene_from_json(std::string_view text, const fs::path& base, const std::string& name,
                                    AssetCache* cache) {
    const Result<Json> json = parse_json(text, name);
    if (!json) return tl::unexpected(json.error());
    AssetCache own;
    AssetCache& assets = cache ? *cache : own;
    Result<LoadedScene> scene = SceneParser(absolute_path(base), name, assets).run(*json);
    if (scene) assets.release_unused();
    return scene;
}

Result<LoadedObject> load_object_file(const fs::path& path, AssetCache* cache) {
    AssetCache own;
    AssetCache& assets = cache ? *cache : own;
    const fs::path file = absolute_path(path);
    LoadedObject loaded;
    loaded.object.name = file.stem().string();
    if (is_gltf_file(file)) {
        const auto gltf = assets.gltf(file);
        if (!gltf) return tl::unexpected(gltf.error());
        loaded.object.shape = Gltf{file.string(), (*gltf)->geometry, {}};
        loaded.materials = (*gltf)->materials;
        loaded.warnings = (*gltf)->warnings;
    } else {
        const MeshResult mesh = assets.mesh(file, &loaded.warnings);
        if (!mesh) return tl::unexpected(mesh.error());
        loaded.object.shape = Mesh{file.string(), *mesh};
    }
    return loaded;
}

Result<Scene> add_to_scene(const Scene& scene, const LoadedObject& loaded) {
    Scene with_materials = scene;
    Object object = loaded.object;
    if (auto* gltf = std::get_if<Gltf>(&object.shape)) {
        const std::string prefix = GltfNames(scene).prefix(gltf->file);
        gltf->materials.clear();
        for (const NamedMaterial& material : loaded.materials) {
            const std::string name = prefix + material.name;
            const MaterialEntry* known = scene.find_material(name);
            gltf->materials.push_back(known ? known->id : MaterialId{with_materials.next_id});
            if (!known)
                with_materials.materials.push_back({MaterialId{with_materials.next_id++}, name, material.material});
        }
    }
    return apply(with_materials, AddObject{std::move(object)});
}

bool is_scene_file(const fs::path& path) {
    return std::ranges::find(kExtensions, lower_extension(path)) != kExtensions.end();
}

Camera frame_bounds(const Bounds3& bounds, float vfov, float aspect) {
    Camera camera;
    camera.vfov = vfov;
    const double radius = 0.5 * glm::length(Vec3d(bounds.extent()));
    if (bounds.empty() || !(radius > 0) || !(radius < 1e18)) return camera;
    const double half_vertical = glm::radians(static_cast<double>(vfov)) / 2;
    const double half_horizontal = std::atan(std::tan(half_vertical) * static_cast<double>(aspect));
    const double distance = 1.05 * radius / std::sin(std::min(half_vertical, half_horizontal));
    const Vec3 towards_eye = glm::normalize(Vec3(0.5f, 0.4f, 1));
    camera.target = bounds.center();
    camera.position = camera.target + static_cast<float>(distance) * towards_eye;
    camera.focus_distance = static_cast<float>(distance);
    return camera;
}

}  // namespace rayuela
