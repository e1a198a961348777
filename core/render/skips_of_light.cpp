#include "core/render/skip_rows.h"

#include "core/render/render_scene.h"

#include <unordered_set>

namespace rayuela {

namespace {

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

Skip lamps_one_by_one(const RenderScene& scene) {
    const bool active = scene.lights().samples_together();
    return {.name = "Points on lamps one by one",
            .state = !scene.features().light_sampling() ? SkipState::absent : skipped_if(active),
            .why = active ? "The lamps are few and plain: points on them are chosen many at once."
                          : "Lamps are many or textured, or there is none.",
            .shortcut = shortcut_of(&Shortcuts::lamp_blocks)};
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

}  // namespace

std::vector<Skip> skips_of_light(const RenderScene& scene) {
    return {shadow_rays(scene),
            black_shadow_rays(scene),
            nearest_hits(scene),
            light_samples_on_mirrors(scene),
            light_samples_of_the_sky(scene),
            choice_among_lights(scene),
            lamps_one_by_one(scene),
            restarts_by_light(scene),
            paths_from_lamps(scene)};
}

}  // namespace rayuela
