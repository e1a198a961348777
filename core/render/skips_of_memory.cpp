#include "core/render/skip_rows.h"

#include "core/accel/kd_accelerator.h"
#include "core/materials/textures.h"
#include "core/render/render_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <unordered_set>

namespace rayuela {

namespace {

const TriangleMesh* mesh_of(const GeometryInstance& instance) {
    const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape);
    return mesh ? mesh->get() : nullptr;
}

Skip hidden_objects(const RenderScene& scene) {
    std::unordered_set<ObjectId> hidden_lists;
    std::uint64_t hidden = 0;
    for (const Object& object : scene.scene().objects) {
        if (object.visible && !hidden_lists.contains(object.parent)) continue;
        if (std::holds_alternative<ObjectList>(object.shape)) {
            hidden_lists.insert(object.id);
        } else {
            ++hidden;
        }
    }
    return {.name = "Hidden objects",
            .state = skipped_where(hidden > 0),
            .why = hidden > 0 ? "They are in no tree and in no list of lights." : "Everything is visible.",
            .saved = hidden,
            .unit = "objects"};
}

/// What meshes would take if each object had one of its own: their geometry shared with the scene, their trees among
/// instances.
std::vector<Skip> copies_of_meshes(const RenderScene& scene) {
    const auto* kd = dynamic_cast<const KdAccelerator*>(&scene.accelerator());
    const std::span<const GeometryInstance> instances = scene.accelerator().instances();
    std::unordered_set<const TriangleMesh*> seen;
    std::uint64_t geometry = 0, trees = 0, repeated = 0;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const TriangleMesh* mesh = mesh_of(instances[i]);
        if (!mesh) continue;
        geometry += mesh->memory_bytes();
        if (seen.insert(mesh).second) continue;
        ++repeated;
        if (kd) trees += kd->mesh_tree(i)->stats.memory_bytes;
    }
    const bool meshes = !seen.empty();
    return {{.name = "Copies of meshes",
             .state = skipped_where(meshes),
             .why = meshes ? "The renderer reads the very meshes that the scene holds." : "There is no mesh.",
             .saved = geometry,
             .unit = "bytes"},
            {.name = "Trees of instances",
             .state = skipped_where(repeated > 0),
             .why = repeated > 0 ? fmt::format("{} of the same mesh share its tree.", count_of(repeated, "more object"))
                    : meshes     ? "No two objects share a mesh."
                                 : "There is no mesh.",
             .saved = trees,
             .unit = "bytes"}};
}

Skip transforms(const RenderScene& scene) {
    const std::uint64_t bytes = scene.surfaces().bytes_left_out();
    return {.name = "Transforms of surfaces",
            .state = skipped_where(bytes > 0),
            .why = bytes > 0 ? "Shapes that have been taken to the world once and for all keep none."
                             : "No shape could do without.",
            .saved = bytes,
            .unit = "bytes"};
}

/// Distinct meshes of visible objects.
std::unordered_set<const TriangleMesh*> meshes_of(const RenderScene& scene) {
    std::unordered_set<const TriangleMesh*> meshes;
    for (const GeometryInstance& instance : scene.accelerator().instances()) {
        if (const TriangleMesh* mesh = mesh_of(instance)) meshes.insert(mesh);
    }
    return meshes;
}

Skip normals_of_vertices(const RenderScene& scene) {
    const auto meshes = meshes_of(scene);
    std::uint64_t bytes = 0;
    for (const TriangleMesh* mesh : meshes) bytes += mesh->normals.empty() ? mesh->positions.size() * sizeof(Vec3) : 0;
    return {.name = "Normals of vertices",
            .state = meshes.empty() ? SkipState::absent : skipped_if(bytes > 0),
            .why = bytes > 0 ? "Meshes without them, or with none but those of their faces, store none and are flat."
                   : meshes.empty() ? "There is no mesh."
                                    : "All meshes bring them.",
            .saved = bytes,
            .unit = "bytes"};
}

Skip uvs_of_vertices(const RenderScene& scene) {
    const auto meshes = meshes_of(scene);
    std::uint64_t missing = 0, aside = 0;
    for (const TriangleMesh* mesh : meshes) {
        missing += mesh->has_uvs() ? 0 : mesh->positions.size() * sizeof(Vec2);
        aside += mesh->bytes_aside();
    }
    return {.name = "Texture coordinates of vertices",
            .state = meshes.empty() ? SkipState::absent : skipped_if(missing + aside > 0),
            .why = aside > 0        ? "No texture reads those of some meshes: they wait in a file."
                   : missing > 0    ? "Meshes without them store none."
                   : meshes.empty() ? "There is no mesh."
                                    : "Textures read them, or they are few.",
            .saved = missing + aside,
            .unit = "bytes"};
}

Skip pixels_of_textures(const RenderScene& scene) {
    std::unordered_set<const Image*> images;
    std::uint64_t bytes = 0, encoded = 0;
    for (const MaterialEntry& entry : scene.scene().materials) {
        for_each_texture(entry.material, [&](const std::shared_ptr<const Image>& image) {
            if (!image || !images.insert(image.get()).second) return;
            if (!image->encoded || image->encoded->if_made()) return;
            ++encoded;
            bytes +=
                static_cast<std::uint64_t>(image->width) * static_cast<std::uint64_t>(image->height) * sizeof(Vec4);
        });
    }
    return {.name = "Pixels of textures",
            .state = images.empty() ? SkipState::absent : skipped_if(encoded > 0),
            .why = encoded > 0      ? fmt::format("Not decoded: {} of {}, which nothing visible shows.", encoded,
                                                  count_of(images.size(), "image"))
                   : images.empty() ? "No material has an image."
                                    : "Visible objects show all images.",
            .saved = bytes,
            .unit = "bytes"};
}

}  // namespace

std::vector<Skip> skips_of_memory(const RenderScene& scene) {
    std::vector<Skip> skips{hidden_objects(scene)};
    std::ranges::move(copies_of_meshes(scene), std::back_inserter(skips));
    skips.insert(skips.end(),
                 {transforms(scene), normals_of_vertices(scene), uvs_of_vertices(scene), pixels_of_textures(scene)});
    return skips;
}

}  // namespace rayuela
