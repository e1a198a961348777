#include "app/skip_gains.h"
#include "app/subcommands.h"
#include "app/text_table.h"
#include "core/render/render_scene.h"
#include "core/render/render_session.h"
#include "core/render/skips.h"
#include "ui/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace rayuela {

namespace {

std::map<std::string, int> count_by_type(const auto& entries, const auto& member) {
    std::map<std::string, int> counts;
    for (const auto& entry : entries) {
        ++counts[std::visit([](const auto& value) { return std::string(value.kType); }, entry.*member)];
    }
    return counts;
}

/// What the meshes of all visible objects hold, each counted once.
nlohmann::ordered_json describe_meshes(std::span<const GeometryInstance> instances) {
    std::set<const TriangleMesh*> meshes;
    for (const GeometryInstance& instance : instances) {
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape))
            meshes.insert(mesh->get());
    }
    double triangles = 0, indices = 0, positions = 0, normals = 0, uvs = 0;
    const auto bytes = [](const auto& values) { return static_cast<double>(values.size() * sizeof(values[0])); };
    for (const TriangleMesh* mesh : meshes) {
        triangles += static_cast<double>(mesh->triangles.size());
        indices += bytes(mesh->triangles);
        positions += bytes(mesh->positions);
        normals += bytes(mesh->normals);
        uvs += bytes(mesh->uvs);
    }
    const auto each = [&](double total) { return triangles > 0 ? std::round(10 * total / triangles) / 10 : 0; };
    return {
        {"count", meshes.size()},
        {"triangles", static_cast<std::uint64_t>(triangles)},
        {"bytes_a_triangle",
         {{"indices", each(indices)}, {"positions", each(positions)}, {"normals", each(normals)}, {"uvs", each(uvs)}}}};
}

nlohmann::ordered_json describe(const RenderScene& built) {
    const Scene& scene = built.scene();
    const AccelStats accel = built.accelerator().stats();
    const double primitives = static_cast<double>(std::max<std::uint64_t>(1, accel.primitives));
    const Bounds3 bounds = world_bounds(scene);
    nlohmann::ordered_json info = {
        {"film", {{"width", scene.film.width}, {"height", scene.film.height}}},
        {"objects", count_by_type(scene.objects, &Object::shape)},
        {"materials", count_by_type(scene.materials, &MaterialEntry::material)},
        {"environment", std::visit([](const auto& e) { return e.kType; }, scene.environment)},
        {"lights", built.lights().size()},
        {"meshes", describe_meshes(built.accelerator().instances())},
        {"accelerator",
         {{"kind", scene.render.accel.kind == AcceleratorKind::kd ? "kd" : "list"},
          {"leaf_size", scene.render.accel.leaf_size},
          {"split", scene.render.accel.split == KdSplit::sah ? "sah" : "median"},
          {"build_seconds", accel.build_seconds},
          {"primitives", accel.primitives},
          {"references", accel.references},
          {"nodes", accel.nodes},
          {"leaves", accel.leaves},
          {"depth", accel.depth},
          {"memory_bytes", accel.memory_bytes},
          {"bytes_a_primitive", std::round(10 * static_cast<double>(accel.memory_bytes) / primitives) / 10}}}};
    if (!bounds.empty()) {
        info["bounds"] = {{"min", {bounds.lo.x, bounds.lo.y, bounds.lo.z}},
                          {"max", {bounds.hi.x, bounds.hi.y, bounds.hi.z}}};
    }
    return info;
}

void print(const nlohmann::ordered_json& info, int indent = 0) {
    for (const auto& [key, value] : info.items()) {
        if (value.is_object()) {
            fmt::print("{:{}}{}\n", "", indent, key);
            print(value, indent + 2);
        } else {
            fmt::print("{:{}}{:<{}} {}\n", "", indent, key, 16 - indent,
                       value.is_string() ? value.get<std::string>() : value.dump());
        }
    }
}

/// One sample of each pixel of a small image, to have something to count.
std::shared_ptr<const Frame> glance_at(Scene scene) {
    scene = shrunk(std::move(scene), 96);
    scene.render.max_samples = 1;
    scene.render.max_seconds = 0;
    RenderSession session({.interactive = false});
    session.submit(std::make_shared<const Scene>(std::move(scene)));
    return session.wait({});
}

/// Null where it was not measured or cannot be put back.
const SkipGain* gain_of(const Skip& skip, const std::vector<SkipGain>& gains) {
    const auto found = std::ranges::find(gains, skip.name, &SkipGain::skip);
    return found == gains.end() ? nullptr : &*found;
}

nlohmann::ordered_json describe(const std::vector<Skip>& skips, const std::vector<SkipGain>& gains,
                                const RenderStatistics& statistics) {
    auto list = nlohmann::ordered_json::array();
    for (const Skip& skip : skips) {
        nlohmann::ordered_json entry = {{"name", skip.name}, {"state", name_of(skip.state)}, {"why", skip.why}};
        if (skip.saved > 0) entry["left_out"] = {{"amount", skip.saved}, {"unit", skip.unit}};
        if (skip.counter) entry["done"] = {{"amount", skip.counter(statistics)}, {"unit", skip.counted}};
        if (const SkipGain* gain = gain_of(skip, gains)) {
            entry["time_with_it"] = {{"ratio", gain->ratio.value},
                                     {"interval", {gain->ratio.interval.low, gain->ratio.interval.high}}};
        }
        list.push_back(std::move(entry));
    }
    return {{"skips", std::move(list)}, {"counted_in_camera_paths", statistics.samples}};
}

void print(const std::vector<Skip>& skips, const std::vector<SkipGain>& gains, const RenderStatistics& statistics) {
    const std::string done = fmt::format("done in {} paths", grouped_text(statistics.samples));
    TextTable table(6, {"what", "state", "left out", done, gains.empty() ? "" : "time with it", "why"});
    for (const Skip& skip : skips) {
        const SkipGain* gain = gain_of(skip, gains);
        table.add({std::string(skip.name), std::string(name_of(skip.state)),
                   skip.saved > 0 ? amount_text(skip.saved, skip.unit) : "",
                   skip.counter ? amount_text(skip.counter(statistics), skip.counted) : "",
                   gain ? fmt::format("x {:.2f}", gain->ratio.value) : "", skip.why});
    }
    fmt::print("{}", table.text());
}

Result<void> print_skips(const Scene& scene, const InfoOptions& options) {
    const auto frame = glance_at(scene);
    if (!frame) return fail("", "", "the scene cannot be rendered");
    std::vector<SkipGain> gains;
    if (options.measure) {
        auto measured = measure_skips(scene, {});
        if (!measured) return tl::unexpected(measured.error());
        gains = std::move(*measured);
    }
    const std::vector<Skip> skips = skips_of(*frame);
    if (options.json) {
        fmt::print("{}\n", describe(skips, gains, frame->statistics).dump(2));
    } else {
        print(skips, gains, frame->statistics);
    }
    return {};
}

}  // namespace

Result<void> run_info(const InfoOptions& options) {
    auto scene = load_scene(options.scene);
    if (!scene) return tl::unexpected(scene.error());
    if (options.skips || options.measure) return print_skips(*scene, options);
    BuildControl control;
    const auto shared = std::make_shared<const Scene>(std::move(*scene));
    const auto built = RenderScene::update(nullptr, shared, all_changes(), control);
    const auto info = describe(*built);
    if (options.json) {
        fmt::print("{}\n", info.dump(2));
    } else {
        print(info);
    }
    return {};
}

}  // namespace rayuela
