#include "core/render/skips.h"

#include "core/accel/kd_accelerator.h"
#include "core/materials/textures.h"
#include "core/render/render_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

namespace rayuela {

namespace {

/// Of what every scene asks for that has no reason to do without.
SkipState skipped_if(bool condition) {
    return condition ? SkipState::skipped : SkipState::needed;
}

/// Of what is always left out where there is some.
SkipState skipped_where(bool present) {
    return present ? SkipState::skipped : SkipState::absent;
}

std::string count_of(std::uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

Skip shadow_rays(const RenderScene& scene) {
    const Features& features = scene.features();
    const bool active = !features.light_sampling();
    return {.name = "Shadow rays",
            .state = skipped_if(active),
            .why = !active ? count_of(scene.lights().size(), "light") + " to aim at."
                   : !features.lights
                       ? "There is neither a lamp nor a panorama to aim at."
                       : "All surfaces are mirrors, clear glass or lamps: only scattered rays find light.",
            .counter = [](const RenderStatistics& s) { return s.shadow_rays; },
            .counted = "shadow rays"};
}

Skip black_shadow_rays(const RenderScene& scene) {
    const bool active = scene.features().light_sampling();
    return {.name = "Shadow rays without light",
            .state = skipped_where(active),
            .why = active
                       ? "No shadow ray where the lamp lies behind the surface, or the surface reflects nothing of it."
                       : "There are no shadow rays.",
            .shortcut = shortcut_of(&Shortcuts::black_shadow_rays)};
}

Skip nearest_hits(const RenderScene& scene) {
    const bool active = scene.features().light_sampling();
    return {.name = "Nearest hits of shadow rays",
            .state = skipped_where(active),
            .why = active ? "The first hit found blocks the light, whichever it is." : "There are no shadow rays.",
            .shortcut = shortcut_of(&Shortcuts::any_hit)};
}

Skip lamps_one_by_one(const RenderScene& scene) {
    const bool active = scene.lights().samples_together();
    return {.name = "Points on lamps one by one",
            .state = !scene.features().light_sampling() ? SkipState::absent : skipped_if(active),
            .why = active ? "The lamps are few and plain: points on them are chosen many at once."
                          : "Lamps are many or textured, or there is none.",
            .shortcut = shortcut_of(&Shortcuts::lamp_blocks)};
}

Skip surfaces_one_by_one(const RenderScene& scene) {
    std::uint64_t plain = 0;
    const auto objects = static_cast<std::uint32_t>(scene.accelerator().instances().size());
    for (std::uint32_t i = 0; i < objects; ++i) plain += scene.packed_material(i).packed.has_value();
    return {.name = "Surfaces one by one",
            .state = skipped_where(plain > 0),
            .why = plain > 0 ? "Surfaces that neither glow nor are partly polished are shaded many at once."
                             : "All surfaces glow or are partly polished.",
            .saved = plain,
            .unit = "objects",
            .shortcut = shortcut_of(&Shortcuts::lobe_blocks)};
}

Skip light_samples_on_mirrors(const RenderScene& scene) {
    std::uint64_t mirrors = 0;
    const std::size_t objects = scene.accelerator().instances().size();
    for (std::uint32_t i = 0; i < objects; ++i) mirrors += !scene.packed_material(i).smooth;
    const bool sampling = scene.features().light_sampling();
    return {.name = "Light samples on mirrors",
            .state = skipped_where(sampling && mirrors > 0),
            .why = !sampling     ? "No surface samples lights."
                   : mirrors > 0 ? "Mirrors, clear glass and lamps reflect nothing of them."
                                 : "No surface is a mirror, clear glass or a lamp.",
            .saved = sampling ? mirrors : 0,
            .unit = "objects"};
}

Skip light_samples_of_the_sky(const RenderScene& scene) {
    const bool shines = scene.features().environment, panorama = scene.environment().image() != nullptr;
    return {.name = "Light samples of the sky",
            .state = skipped_if(!panorama),
            .why = panorama ? "A panorama has bright spots to aim at."
                   : shines ? "Scattered rays find a sky without bright spots with less noise."
                            : "There is no light from outside."};
}

Skip choice_among_lights(const RenderScene& scene) {
    const std::size_t lamps = scene.lights().lights().size();
    return {.name = "Choice among lamps",
            .state = skipped_if(lamps <= 1),
            .why = lamps == 0   ? "No lamp can be sampled: there is not even a list of them."
                   : lamps == 1 ? "There is only one lamp."
                                : count_of(lamps, "surface") + " of lamps stand in a tree."};
}

/// Things that give light which an edit changes alone.
std::size_t sources(const RenderScene& scene) {
    std::unordered_set<const PackedMaterial*> lamps;
    const auto objects = static_cast<std::uint32_t>(scene.accelerator().instances().size());
    for (std::uint32_t i = 0; i < objects; ++i) {
        if (scene.packed_material(i).emissive) lamps.insert(&scene.packed_material(i));
    }
    return lamps.size() + (scene.features().environment ? 1 : 0);
}

Skip restarts_by_light(const RenderScene& scene) {
    const std::size_t count = sources(scene);
    return {.name = "Restarts by edits of light",
            .state = count == 0 ? SkipState::absent : skipped_if(count == 1),
            .why = count == 0   ? "There is no light."
                   : count == 1 ? "All light is one: made brighter, darker or of another colour, it scales the image "
                                  "that is there, unless samples are clamped."
                                : count_of(count, "light") + " are mixed in the image: it is scaled only with all."};
}

Skip paths_from_lamps(const RenderScene& scene) {
    const Features& features = scene.features();
    const bool active = scene.emission() == nullptr;
    return {.name = "Paths from lamps",
            .state = skipped_if(active),
            .why = !active              ? "Lamps shine on mirrors or glass, which throws caustics."
                   : !features.emitters ? "There is no lamp."
                   : !features.light_sampling()
                       ? "No surface would show a caustic of a lamp."
                       : "No lamp shines on a mirror or on clear glass: there are no caustics.",
            .counter = [](const RenderStatistics& s) { return s.lamp_paths; },
            .counted = "lamp paths"};
}

Skip bounces(const RenderScene& scene) {
    const bool active = !scene.features().any_light();
    return {.name = "Bounces",
            .state = skipped_if(active),
            .why = active ? "Nothing gives light: paths end where they hit something." : "There is light to find.",
            .counter = [](const RenderStatistics& s) { return s.rays - std::min(s.rays, s.samples); },
            .counted = "scattered rays",
            .shortcut = shortcut_of(&Shortcuts::no_light)};
}

Skip environment(const RenderScene& scene) {
    const bool active = !scene.features().environment;
    return {.name = "Environment",
            .state = skipped_if(active),
            .why = active ? "No light comes from outside: a ray that leaves ends." : "Light comes from outside.",
            .counter = [](const RenderStatistics& s) { return s.environment_lookups; },
            .counted = "look-ups",
            .shortcut = shortcut_of(&Shortcuts::no_sky)};
}

Skip lens_samples(const RenderScene& scene) {
    const bool active = !scene.features().lens;
    return {.name = "Lens samples",
            .state = skipped_if(active),
            .why = active ? "The lens is a point: everything is in focus." : "The lens has an extent.",
            .shortcut = shortcut_of(&Shortcuts::no_lens)};
}

Skip textures(const RenderScene& scene) {
    const bool active = !scene.features().textures;
    return {
        .name = "Textures",
        .state = skipped_if(active),
        .why = active
                   ? "No material varies over a surface: each is worked out once, and no hit has texture coordinates."
                   : "A material varies over its surface.",
        .counter = [](const RenderStatistics& s) { return s.textured_hits; },
        .counted = "textured hits",
        .shortcut = shortcut_of(&Shortcuts::ready_materials)};
}

/// Objects that have a place in a tree.
std::uint64_t bounded_objects(const RenderScene& scene) {
    const auto is_plane = [](const GeometryInstance& i) { return std::holds_alternative<Plane>(i.shape); };
    const std::span<const GeometryInstance> instances = scene.accelerator().instances();
    return instances.size() - static_cast<std::uint64_t>(std::ranges::count_if(instances, is_plane));
}

const TriangleMesh* mesh_of(const GeometryInstance& instance) {
    const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape);
    return mesh ? mesh->get() : nullptr;
}

Skip tree_over_objects(const RenderScene& scene) {
    const std::uint64_t objects = bounded_objects(scene);
    const auto* kd = dynamic_cast<const KdAccelerator*>(&scene.accelerator());
    const bool few = kd && !kd->has_object_tree();
    const bool can_do_without =
        kd && objects > 1 && tests_few_objects(kd->settings(), scene.accelerator().instances().size());
    return {.name = "Tree over the objects",
            .state = skipped_if(!kd || few || can_do_without),
            .why = !kd ? "Every object is tried in turn, as the settings say."
                   : few && objects > 1
                       ? "Testing all " + count_of(objects, "object") + " for 16 rays at once is faster."
                   : objects > 1  ? count_of(objects, "object") + " stand in it."
                   : objects == 1 ? "There is one object: rays go straight to it."
                                  : "There is no object that a tree could hold.",
            .shortcut = can_do_without ? shortcut_of(&Shortcuts::few_objects) : nullptr};
}

Skip large_objects(const RenderScene& scene) {
    const auto* kd = dynamic_cast<const KdAccelerator*>(&scene.accelerator());
    const std::size_t large = kd ? kd->large_objects() : 0;
    return {.name = "Large objects in leaves",
            .state = skipped_where(large > 0),
            .why = large > 0 ? "Beside the tree they are tested once with every ray, not in leaf after leaf."
                             : "No object is large beside a tree over the others.",
            .saved = large,
            .unit = "objects",
            .shortcut = large > 0 ? shortcut_of(&Shortcuts::few_objects) : nullptr};
}

Skip cells_of_trees(const RenderScene& scene) {
    const AccelStats stats = scene.accelerator().stats();
    const bool active = stats.nodes == stats.leaves;
    return {.name = "Cells of trees",
            .state = skipped_if(active),
            .why = active ? "All that there is fits into one leaf, or is tried in turn." : "Leaves have to be found.",
            .counter = [](const RenderStatistics& s) { return s.accel.nodes - s.accel.leaves; },
            .counted = "inner nodes"};
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

Skip samples_of_finished_pixels(const RenderStatistics& statistics) {
    const SampleSpread& spread = statistics.spread;
    const bool active = spread.finished_pixels > 0;
    return {.name = "Samples of finished pixels",
            .state = active                ? SkipState::skipped
                     : statistics.adaptive ? SkipState::absent
                                           : SkipState::needed,
            .why = !statistics.adaptive ? "Adaptive sampling is off: all pixels get the same number."
                   : active ? fmt::format("{:.1f} % of the pixels are as the target error asks: the others go on.",
                                          100 * spread.finished_pixels)
                            : "No pixel is finished yet.",
            .saved = spread.saved,
            .unit = "samples"};
}

}  // namespace

std::string_view name_of(SkipState state) {
    constexpr std::string_view kNames[] = {"skipped", "put back", "needed", "absent"};
    return kNames[static_cast<std::size_t>(state)];
}

std::vector<Skip> skips_of(const RenderScene& scene) {
    std::vector<Skip> skips{shadow_rays(scene),
                            black_shadow_rays(scene),
                            nearest_hits(scene),
                            light_samples_on_mirrors(scene),
                            light_samples_of_the_sky(scene),
                            choice_among_lights(scene),
                            lamps_one_by_one(scene),
                            surfaces_one_by_one(scene),
                            restarts_by_light(scene),
                            paths_from_lamps(scene),
                            bounces(scene),
                            environment(scene),
                            lens_samples(scene),
                            textures(scene),
                            tree_over_objects(scene),
                            large_objects(scene),
                            cells_of_trees(scene),
                            hidden_objects(scene)};
    std::ranges::move(copies_of_meshes(scene), std::back_inserter(skips));
    skips.push_back(transforms(scene));
    skips.push_back(normals_of_vertices(scene));
    skips.push_back(uvs_of_vertices(scene));
    skips.push_back(pixels_of_textures(scene));
    return skips;
}

std::vector<Skip> skips_of(const Frame& frame) {
    std::vector<Skip> skips = skips_of(*frame.render_scene);
    for (Skip& skip : skips) {
        if (!skip.shortcut || frame.statistics.shortcuts.*skip.shortcut->member) continue;
        if (skip.state == SkipState::skipped) skip.state = SkipState::put_back;
        skip.why = skip.shortcut->put_back;
    }
    skips.push_back(samples_of_finished_pixels(frame.statistics));
    return skips;
}

}  // namespace rayuela
