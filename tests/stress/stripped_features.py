"""What a scene may hold, feature by feature: how stripped.py takes the code for it out of the program, and examples that have
none of it. A replacement is (file, old, new); each old stands once in its file."""

TRACER, LOBES, TRACER_H = "core/render/path_tracer.cpp", "core/render/path_tracer_lobes.cpp", "core/render/path_tracer.h"
STARTS = "core/render/path_tracer_camera.cpp"
INTERACTION, AIMED, BLOCK = "core/render/interaction.h", "core/render/aimed_bsdf.h", "core/render/lobe_block.cpp"
CAMERA, FILM = "core/render/camera_ray_lanes.cpp", "core/render/accumulation.cpp"
KERNELS, FEW, CLIENT = "core/accel/kd_kernels.cpp", "core/accel/few_objects-inl.h", "core/accel/object_lanes-inl.h"
RAY_BLOCK = "core/accel/ray_block-inl.h"
SURFACES, SURFACE_OF = "core/accel/surface_point.cpp", "core/accel/surface_of.h"
SKY, LIGHTS, LAMPS = "core/lights/environment_light.cpp", "core/lights/light_table.cpp", "core/lights/few_lamps.cpp"
PRINCIPLED = "core/materials/principled.cpp"


def together(*features):
    """All of these out, each replacement once; where two replace the same, as the last has it."""
    return list({(file, old): (file, old, new) for feature in features for file, old, new in feature}.values())


def without_lobe(kind, lobe):
    """Surfaces of this PackedBsdf::Kind are not shaded."""
    return BLOCK, f"return scatter_as<Kind::{kind}, {lobe}>(task, paths, block);", "return;"


def with_kinds(kinds):
    """Only blocks of these kinds are looked at."""
    names = ", ".join(f"PackedBsdf::Kind::{kind}" for kind in kinds)
    return TRACER, "for (const PackedBsdf::Kind kind : PackedBsdf::kKinds)", f"for (const PackedBsdf::Kind kind : {{{names}}})"


TEXTURES = [
    (TRACER, "    const bool materials_vary = scene_.features().textures || !options_.shortcuts.ready_materials;\n", ""),
    (TRACER, "return materials_vary ? trace_as<true>(batch, cancelled, record) : trace_as<false>(batch, cancelled, record);",
     "return trace_as<false>(batch, cancelled, record);"),
    (INTERACTION, ",\n          varying_(varies ? std::optional(make_bsdf(packed.material, surface.uv)) : std::nullopt) {}",
     " {\n        static_cast<void>(varies);\n    }"),
    (INTERACTION, "return varying_ ? *varying_ : material.bsdf;", "return material.bsdf;"),
    (INTERACTION, "    std::optional<Bsdf> varying_;  ///< Where the material is textured.\n", ""),
    (SURFACES, "[&](std::size_t i) { return kDetails && !with_uv.empty() && with_uv[i] != 0; };",
     "[&](std::size_t) { return static_cast<void>(with_uv), false; };"),
    (SURFACES, "has_meshes_ || !with_uv.empty() ?", "has_meshes_ ?"),
]
SHADING_NORMALS = [
    (INTERACTION, "return (glm::dot(w, point.ng) > 0) == (glm::dot(w, point.ns) > 0) ? point.ns : point.ng;",
     "return static_cast<void>(w), point.ng;"),
    (BLOCK, "frame(task.interpolates ? shading_normal(load(block.wo, i), ng, load(block.ns, i)) : ng),", "frame(ng),"),
    (BLOCK, "    if (task.interpolates) store(Vec3Lanes{c.y, c.z, c.w}, block.ns, i);\n", "    static_cast<void>(task);\n"),
    (SURFACES, "if (wants_uv(i) || entries_[hits[i].object].interpolates)", "if (wants_uv(i))"),
    (SURFACES, "    point.ns = surface.ng;\n", ""),
    (SURFACES, "            if (ns != Vec3(0)) point.ns = ns;\n", ""),
    (SURFACES, "            const Vec3 ns = surface.shading_normal(hit);\n", ""),
    (SURFACES, "                    if (!mesh->normals.empty()) __builtin_prefetch(&mesh->normals[t[corner]]);\n", ""),
]
LENSES = [
    (STARTS, "    draw_lens(batch);\n", ""),
    (CAMERA, "const bool with_lens = model.lens_radius != 0;", "const bool with_lens = false;"),
]
SKIES = [
    (TRACER, "      sees_sky_(scene.features().environment || !options.shortcuts.no_sky),\n", ""),
    (TRACER_H, "    bool sees_sky_; ", "    static constexpr bool sees_sky_ = false; "),
]
PANORAMAS = [
    (SKY, "    if (image_) return scale_ * look_up(*image_, image_position(w));\n", ""),
    (SKY, "Color look_up(const", "[[maybe_unused]] Color look_up(const"),
    (LIGHTS, "    if (u.x < environment_probability_) return sample_environment({u.x / environment_probability_, u.y});\n"
             "    const float rest = (u.x - environment_probability_) / (1 - environment_probability_);\n"
             "    return sample_area_light(receiver, {std::min(rest, 1 - kUnitRoundoff), u.y});",
     "    return sample_area_light(receiver, {std::min(u.x, 1 - kUnitRoundoff), u.y});"),
    (LIGHTS, "if (s) s->pdf *= (1 - environment_probability_) * draw->probability;", "if (s) s->pdf *= draw->probability;"),
    (LIGHTS, "return (1 - environment_probability_) * selection *", "return selection *"),
    (LIGHTS, "return environment_ ? environment_probability_ * environment_->pdf(wi) : 0.0f;",
     "return static_cast<void>(wi), 0.0f;"),
]
LAMP_PATHS = [
    (TRACER, "    may_aim_ = light_tracer_ && light_tracer_->lamps_are_small();\n", ""),
    (TRACER_H, "    bool may_aim_ = false; ", "    static constexpr bool may_aim_ = false; "),
    (TRACER, "light_tracer_ ? light_tracer_->camera_weight(state.light_ratio, hit, at) : 1;", "1;"),
    (TRACER, "if (light_tracer_) next.light_ratio", "if (false) next.light_ratio"),
    (LOBES, "    if (light_tracer_) find_light_ratios", "    if (false) find_light_ratios"),
]
LAMPS_AND_EMISSION = LAMP_PATHS + [
    (TRACER, "    if (material.emissive) batch.radiance[state.part] += emitted_light(state, ray, batch.hits[i], at);\n",
     "    static_cast<void>(at), static_cast<void>(state);\n"),
    (TRACER, "      light_sampling_(options.light_sampling && scene.features().light_sampling()),\n", ""),
    (TRACER_H, "    bool light_sampling_;\n", "    static constexpr bool light_sampling_ = false;\n"),
    (LOBES, "    if (task.samples_lights) scene_.lights().sample(block.light, options_.shortcuts.lamp_blocks);\n", ""),
    (LOBES, "for (std::uint64_t rest = block.casts_shadow_ray; rest != 0; rest &= rest - 1) {",
     "for (std::uint64_t rest = 0; false;) {"),
    (BLOCK, "        if (!task.samples_lights) continue;\n", "        continue;\n"),
    (BLOCK, "            if (task.samples_lights) {\n", "            if (false) {\n"),
]
MANY_LAMPS = [
    (LIGHTS, "if (few_ && together) {", "static_cast<void>(together);\n    if (true) {"),
    (LIGHTS, "const float selection = tree_.probability(receiver, light);",
     "const float selection = tree_.only_light() == light ? 1.0f : 0.0f;"),
    (LAMPS, "if (lamps.count == 1) return {", "if (true) return {"),
    (LAMPS, "return lamps_.count == 1 ? all_lanes(row[0]) : looked_up(FloatTag(), row, lamp_);", "return all_lanes(row[0]);"),
]
SPHERES = [
    (FEW, "const bool spheres = leaf_.spheres > 0;", "const bool spheres = false;"),
    (LAMPS, "        if (!lamps_.any_flat) return sphere_points(of(lamps_.origin), of(lamps_.size), p, u);\n", ""),
    (LAMPS, "        if (!lamps_.any_sphere) return flat;\n", "        if (true) return flat;\n"),
    (SURFACES, "} else if (entry.sphere && !wants_uv(i)) {", "} else if (false) {"),
    (SURFACES, "    finish_flats();\n    finish_spheres();\n", "    finish_flats();\n"),
]
PLANES = [
    (KERNELS, "for (const std::uint32_t index : scene.planes) {", "for (const std::uint32_t index : {0u}) {\n        break;"),
    (KERNELS, "scene.planes.empty() ? open_rays<Query::closest>(hits, work) : open_rays<kQuery>(hits, work);",
     "open_rays<Query::closest>(hits, work);"),
]
MESHES = [
    (KERNELS, "    if (const auto mesh = only_mesh(scene)) {", "    if (std::optional<std::uint32_t> mesh; false) {"),
    (KERNELS, "    trace_candidates<kQuery>(scene, rays, hits, work);\n}", "}"),
    (FEW, "                if (scene_.mesh_trees[object]) {", "                if (false) {"),
    (CLIENT, "                if (scene_.mesh_trees[object]) {", "                if (false) {"),
    (SURFACES, "        if (kDetails && has_meshes_) {", "        if (false) {"),
    (SURFACES, "has_meshes_ || !with_uv.empty() ?", "!with_uv.empty() ?"),
]
BOXES_AND_MESHES = [change for change in MESHES if change[0] in (KERNELS, SURFACES)] + [
    (FEW, "        if (leaf_.others > 0) each_group(kAxis, [&](const WorldRays& rays) HWY_ATTR { test_others(rays); });\n", ""),
    (CLIENT, "            test_others(ray_of_slot_[visit.slot], leaf);\n", ""),
    (CLIENT, "        for (LaneBits rest = leaf.others > 0 ? lanes : 0; rest != 0; rest &= rest - 1)\n"
             "            test_others(first_ + first_lane(rest), leaf);\n", ""),
]
FLAT_SHAPES = [
    (FEW, "const std::size_t pairs = scene_.leaves->apart_pairs.pairs.size();", "const std::size_t pairs = 0;"),
    (CLIENT, "          any_triangles_(leaves_.triangle_runs.size() > kRunPadding),\n", ""),
    (CLIENT, "    const bool any_triangles_, any_spheres_;", "    static constexpr bool any_triangles_ = false;\n    const bool any_spheres_;"),
    (CLIENT, "            add_triangles(visit.slot, leaf);\n", ""),
    (CLIENT, "        decide_triangles();\n        decide_spheres();\n", "        decide_spheres();\n"),
    (CLIENT, "        packet_.test(\n            runs, leaf.triangles, mask_of(lanes),", "        packet_.test(\n            runs, 0, mask_of(lanes),"),
    (SURFACES, "        if (entry.flat) {", "        if (false) {"),
    (SURFACES, "    finish_flats();\n    finish_spheres();\n", "    finish_spheres();\n"),
]
TRANSFORMS = [
    (RAY_BLOCK, "        if (to_local_) {", "        if (false) {"),
    (RAY_BLOCK, "to_local_ ? hn::LoadU(df, block.pad + i) : least", "least"),
    (SURFACE_OF, "bool in_world() const { return in_world_; }", "bool in_world() const { return true; }"),
    (SURFACE_OF, "RayD ray(const Ray& world) const { return in_world_ ? RayD(world) : to_local().ray(RayD(world)); }",
     "RayD ray(const Ray& world) const { return RayD(world); }"),
    (SURFACE_OF, "Vec3d point(const Vec3d& p) const { return in_world_ ? p : to_world().point(p); }",
     "Vec3d point(const Vec3d& p) const { return p; }"),
    (SURFACE_OF, "Vec3d normal(const Vec3d& n) const { return in_world_ ? n : way_->normals * n; }",
     "Vec3d normal(const Vec3d& n) const { return n; }"),
]
TRANSMISSION = [
    (INTERACTION, "        if (material.transmits) return Vec3(0);\n", ""),
    (AIMED, "if (!targets || at.material.transmits || !at.material.smooth) return;", "if (!targets || !at.material.smooth) return;"),
    without_lobe("glass", "GlassLobe"),
    without_lobe("frosted", "FrostedLobe"),
    without_lobe("see_through", "PrincipledLobe<true>"),
    with_kinds(["matte", "facets", "dull", "mirror", "layered"]),
    (BLOCK, "transmits(task.kind) ? all_lanes(Vec3(0)) : n", "n"),
    (PRINCIPLED, "enum Lobe { kCoat, kFacets, kBody, kThroughFacets, kThroughBody, kLobeCount };",
     "enum Lobe { kCoat, kFacets, kBody, kLobeCount };"),
    (PRINCIPLED, "        albedo[kThroughFacets] = below_coat * (1 - b.dielectric_f0) * (facets.total - facets.grazing) * b.transmission;\n"
                 "        albedo[kThroughBody] = below_coat * lost * b.transmission;\n", ""),
    (PRINCIPLED, "        return {\n"
                 "            split.below_coat * transmission * ((1 - schlick(dielectric_f0, o_m)) * facet_weight + lost * cosine_pdf),\n"
                 "            split.probability[kThroughFacets] * facet_pdf + split.probability[kThroughBody] * cosine_pdf};\n",
     "        return {};\n"),
    (PRINCIPLED, "    const bool passes = lobe == kThroughFacets || lobe == kThroughBody;\n"
                 "    const bool from_body = lobe == kBody || lobe == kThroughBody;\n", "    const bool from_body = lobe == kBody;\n"),
    (PRINCIPLED, "if (passes != (wo.z < 0)) wi.z = -wi.z;", "if (wo.z < 0) wi.z = -wi.z;"),
]
DELTA_LOBES = [
    without_lobe("mirror", "MirrorLobe"),
    without_lobe("glass", "GlassLobe"),
    with_kinds(["matte", "facets", "dull", "frosted", "layered", "see_through"]),
    (TRACER, "rr_start_ + (specular ? kSparedSpecularBounces : 0);", "static_cast<void>(specular), rr_start_;"),
    (TRACER, "next.bsdf_pdf = sample->specular ? 0 : sample->pdf;", "next.bsdf_pdf = sample->pdf;"),
    (LOBES, ".specular = is_delta(kind)}", ".specular = false}"),
    (LOBES, ".samples_lights = light_sampling_ && !is_delta(kind),", ".samples_lights = light_sampling_,"),
]
ALL_LOBES_BUT_MATTE = together(TRANSMISSION, DELTA_LOBES, [
    without_lobe("facets", "FacetLobe"),
    without_lobe("dull", "DullLobe"),
    without_lobe("layered", "PrincipledLobe<false>"),
    with_kinds(["matte"]),
    (TRACER, "batch.lobes[static_cast<std::size_t>(lobe.kind)];\n    const", "batch.lobes[0];\n    const"),
    (TRACER, "if (block.size == LobeBlock::kSize) shade_block(batch, lobe.kind, bounce);",
     "if (block.size == LobeBlock::kSize) shade_block(batch, PackedBsdf::Kind::matte, bounce);"),
])
ADAPTIVE = [
    (FILM, "        !adapts() && options_.clamp == 0 && tile.adaptive.shows_all_from(static_cast<std::uint32_t>(tile.samples));",
     "        (static_cast<void>(tile), true);"),
]

FEATURES = {
    "textures": (TEXTURES, ["cornell", "materials", "veach", "weekend"]),
    "interpolated normals": (SHADING_NORMALS, ["cornell", "materials", "veach", "weekend"]),
    "transmission": (TRANSMISSION, ["cornell", "dragon", "many_lights", "veach"]),
    "mirrors and clear glass": (DELTA_LOBES, ["cornell", "many_lights", "veach"]),
    "all lobes but matte": (ALL_LOBES_BUT_MATTE, ["cornell", "fig1a", "fig2"]),
    "lamps": (LAMPS_AND_EMISSION, ["weekend"]),
    "more than one lamp": (MANY_LAMPS, ["cornell", "fig1a", "fig2"]),
    "paths from lamps": (LAMP_PATHS, ["cornell", "dragon", "veach", "weekend"]),
    "skies": (SKIES, ["cornell", "many_lights", "veach"]),
    "panoramas": (PANORAMAS, ["fig1a", "final", "many_lights", "weekend"]),
    "lenses": (LENSES, ["cornell", "materials", "veach"]),
    "spheres": (SPHERES, ["cornell"]),
    "triangles and quads": (FLAT_SHAPES, ["weekend"]),
    "planes": (PLANES, ["cornell", "many_lights", "weekend"]),
    "meshes": (MESHES, ["cornell", "materials", "veach", "weekend"]),
    "boxes and meshes": (BOXES_AND_MESHES, ["fig1a", "fig3", "weekend"]),
    "transformed meshes": (TRANSFORMS, ["dragon"]),
    "adaptive sampling and clamping": (ADAPTIVE, ["cornell", "weekend"]),
    "all of these that cornell lacks": (
        together(TEXTURES, SHADING_NORMALS, TRANSMISSION, ALL_LOBES_BUT_MATTE, MANY_LAMPS, LAMP_PATHS, SKIES, PANORAMAS, LENSES,
                 SPHERES, PLANES, MESHES), ["cornell"]),
}
