#include "app/subcommands.h"
#include "core/math/sampling.h"
#include "core/render/path_tracer.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

std::string text(const Vec3& v) {
    return fmt::format("({:.6g} {:.6g} {:.6g})", v.x, v.y, v.z);
}

std::string name_of(const RenderScene& scene, const Hit& hit) {
    const Object* object = scene.scene().find(scene.object_id(hit.object));
    const Material& material = scene.material(hit.object);
    const std::string_view kind = std::visit([](const auto& m) { return m.kType; }, material);
    return fmt::format("{} (primitive {}), {}", object ? object->name : "?", hit.primitive, kind);
}

/// How the light that a ray meets is shared with light samples: by the densities of both.
std::string weight_of(float bsdf_pdf, float light_pdf) {
    if (bsdf_pdf == 0) return "weight 1 (camera or delta)";
    return fmt::format("light pdf {:.6g}, MIS weight {:.6g}", light_pdf,
                       light_pdf > 0 ? power_heuristic(bsdf_pdf, light_pdf) : 1.0f);
}

void print_arrival(const RenderScene& scene, const PathRecord::Vertex& v) {
    fmt::print("bounce {}: throughput {}, pdf {:.6g}\n", v.bounce, text(v.state.throughput), v.state.bsdf_pdf);
    fmt::print("  ray         {} along {}\n", text(v.ray.origin + scene.origin()), text(v.ray.direction));
    if (!v.hit.valid()) {
        fmt::print("  environment {}, {}\n", text(scene.environment().radiance(v.ray.direction)),
                   weight_of(v.state.bsdf_pdf, scene.lights().environment_pdf(v.ray.direction)));
        return;
    }
    fmt::print("  hit         {} at t {:.9g}\n", name_of(scene, v.hit), v.hit.t);
    fmt::print("  point       {} +- {}\n", text(v.point.p + scene.origin()), text(v.point.p_error));
    fmt::print("  normal      {} shading {}, uv ({:.6g} {:.6g})\n", text(v.point.ng), text(v.point.ns), v.point.uv.x,
               v.point.uv.y);
    const bool front = glm::dot(v.ray.direction, v.point.ng) < 0;
    const Color light = emitted(scene.material(v.hit.object), v.point.uv, front);
    if (is_black(light)) return;
    const float light_pdf = v.state.bsdf_pdf > 0 && !scene.lights().empty()
                                ? scene.lights().pdf(v.state.receiver, v.ray.direction, v.hit, v.point.p, v.point.ng)
                                : 0.0f;
    fmt::print("  emits       {}, {}\n", text(light), weight_of(v.state.bsdf_pdf, light_pdf));
}

void print(const RenderScene& scene, const PathRecord& record) {
    std::size_t vertex = 0, light = 0;
    for (std::size_t bounce = 0; bounce < record.radiance.size(); ++bounce) {
        const auto now = static_cast<int>(bounce);
        for (; vertex < record.vertices.size() && record.vertices[vertex].bounce == now; ++vertex)
            print_arrival(scene, record.vertices[vertex]);
        for (; light < record.light_samples.size() && record.light_samples[light].bounce == now; ++light) {
            const PathRecord::LightSample& s = record.light_samples[light];
            fmt::print("  light       {} along {}: {}\n", text(s.light), text(glm::normalize(s.ray.direction)),
                       s.blocked ? "blocked" : "free");
        }
        fmt::print("  radiance    {}\n", text(record.radiance[bounce]));
    }
}

}  // namespace

Result<void> run_replay(const RenderOptions& options) {
    auto loaded = load_scene(options.scene, options.overrides);
    if (!loaded) return tl::unexpected(loaded.error());
    const FilmSettings film = loaded->film;
    const ReplayedSample& at = *options.replay;
    if (at.x < 0 || at.y < 0 || at.x >= film.width || at.y >= film.height || at.sample < 0) {
        return fail(
            "", "--replay",
            fmt::format("{},{},{} is no sample of a film of {} x {}", at.x, at.y, at.sample, film.width, film.height));
    }
    BuildControl control;
    const auto scene =
        RenderScene::update(nullptr, std::make_shared<const Scene>(std::move(*loaded)), all_changes(), control);
    const PathId id{static_cast<std::uint32_t>(at.y * film.width + at.x), static_cast<std::uint32_t>(at.sample)};
    PathRecord record;
    const Color radiance = trace_one(*scene, id, {}, &record);
    fmt::print("pixel {},{} sample {}\n", at.x, at.y, at.sample);
    print(*scene, record);
    fmt::print("sample {}\n", text(radiance));
    return {};
}

}  // namespace rayuela
