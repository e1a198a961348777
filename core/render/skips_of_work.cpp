#include "core/render/skip_rows.h"

#include "core/accel/kd_accelerator.h"
#include "core/render/passing_rays.h"
#include "core/render/render_scene.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayuela {

namespace {

Skip passing_rays(const RenderScene& scene, const RenderStatistics& statistics) {
    const FilmSettings& film = scene.scene().film;
    const CameraRays camera(scene.camera(), static_cast<double>(film.width) / film.height);
    const bool active = PassingRays(scene.accelerator(), camera).possible();
    const double share = static_cast<double>(statistics.passing_rays) /
                         static_cast<double>(std::max<std::uint64_t>(1, statistics.samples));
    return {.name = "Camera rays past everything",
            .state = skipped_if(active),
            .why = !active     ? "Each of them may meet something."
                   : share > 0 ? fmt::format("{:.1f} % go straight to the environment: they pass the bounds of all "
                                             "objects by.",
                                             100 * share)
                               : "Those that pass the bounds of all objects by go straight to the environment.",
            .saved = statistics.passing_rays,
            .unit = "rays",
            .shortcut = shortcut_of(&Shortcuts::passing_rays)};
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

}  // namespace

std::vector<Skip> skips_of_work(const RenderScene& scene, const RenderStatistics& statistics) {
    return {passing_rays(scene, statistics),
            bounces(scene),
            environment(scene),
            lens_samples(scene),
            surfaces_one_by_one(scene),
            textures(scene),
            tree_over_objects(scene),
            large_objects(scene),
            cells_of_trees(scene)};
}

}  // namespace rayuela
