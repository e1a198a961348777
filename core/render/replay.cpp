#include "core/render/replay.h"

#include "core/math/sampling.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

void set_weight(const PathState& state, float light_pdf, ReplayRow& row) {
    if (state.bsdf_pdf > 0) {
        const float weight = light_pdf > 0 ? power_heuristic(state.bsdf_pdf, light_pdf) : 1.0f;
        row.weight = fmt::format("{:.6g} (light pdf {:.6g})", weight, light_pdf);
    } else {
        row.weight = state.light_ratio > 0 ? "shared with paths from lamps" : "1";
    }
}

std::string object_text(const RenderScene& scene, const Hit& hit) {
    const Object* object = scene.scene().find(scene.object_id(hit.object));
    return fmt::format("{} ({})", object ? object->name : "?", hit.primitive);
}

ReplayRow arrival(const RenderScene& scene, const PathRecord::Vertex& v) {
    ReplayRow row;
    row.bounce = v.bounce;
    row.throughput = to_text(v.state.throughput);
    row.pdf = v.state.bsdf_pdf == 0 ? "delta" : fmt::format("{:.6g}", v.state.bsdf_pdf);
    row.ray = fmt::format("{} along {}", to_text(v.ray.origin + scene.origin()), to_text(v.ray.direction));
    if (!v.hit.valid()) {
        row.object = "environment";
        row.light = to_text(scene.environment().radiance(v.ray.direction));
        set_weight(v.state, scene.lights().environment_pdf(v.ray.direction), row);
        return row;
    }
    const Material& material = scene.material(v.hit.object);
    row.object = object_text(scene, v.hit);
    row.material = std::visit([](const auto& m) { return m.kType; }, material);
    row.t = fmt::format("{:.9g}", v.hit.t);
    row.point = to_text(v.point.p + scene.origin());
    row.error = to_text(v.point.p_error);
    const Vec2 uv = surface_point(scene.accelerator().instances(), v.ray, v.hit).uv;  // the path may not have it
    row.normal = fmt::format("{} shading {}, uv ({:.6g} {:.6g})", to_text(v.point.ng), to_text(v.point.ns), uv.x, uv.y);
    const bool front = glm::dot(v.ray.direction, v.point.ng) < 0;
    const Color light = emitted(material, uv, front);
    if (is_black(light)) return row;
    row.light = to_text(light);
    const bool sampled = v.state.bsdf_pdf > 0 && !scene.lights().empty();
    set_weight(v.state,
               sampled ? scene.lights().pdf(v.state.receiver, v.ray.direction, v.hit, v.point.p, v.point.ng) : 0, row);
    return row;
}

ReplayRow light_sample(const RenderScene& scene, const PathRecord::LightSample& s) {
    ReplayRow row;
    row.bounce = s.bounce;
    row.object = s.blocked ? "light sample, blocked" : "light sample, free";
    row.light = to_text(s.light);
    row.ray =
        fmt::format("{} along {}", to_text(s.ray.origin + scene.origin()), to_text(glm::normalize(s.ray.direction)));
    return row;
}

std::vector<ReplayRow> rows_of(const RenderScene& scene, const PathRecord& record) {
    std::vector<ReplayRow> rows;
    auto vertex = record.vertices.begin();
    auto light = record.light_samples.begin();
    for (std::size_t bounce = 0; bounce < record.radiance.size(); ++bounce) {
        const auto now = static_cast<int>(bounce);
        for (; vertex != record.vertices.end() && vertex->bounce == now; ++vertex)
            rows.push_back(arrival(scene, *vertex));
        for (; light != record.light_samples.end() && light->bounce == now; ++light)
            rows.push_back(light_sample(scene, *light));
        rows.back().radiance = to_text(record.radiance[bounce]);
    }
    return rows;
}

}  // namespace

Replay replay(const RenderScene& scene, const PathId& id) {
    PathRecord record;
    const Color radiance = trace_one(scene, id, {}, &record);
    return {id, rows_of(scene, record), radiance};
}

std::string to_text(const Vec3& v) {
    return fmt::format("({:.6g} {:.6g} {:.6g})", v.x, v.y, v.z);
}

std::string to_text(const Replay& replay) {
    std::string text;
    for (const ReplayRow& row : replay.rows) {
        text += fmt::format("bounce {}\n", row.bounce);
        for (const ReplayField& field : kReplayFields) {
            const std::string& value = row.*field.text;
            if (!value.empty()) text += fmt::format("  {:<11} {}\n", field.name, value);
        }
    }
    return text + fmt::format("sample {}\n", to_text(replay.radiance));
}

}  // namespace rayuela
