#include "app/skip_gains.h"
#include "app/subcommands.h"
#include "app/text_table.h"
#include "core/accel/kd_accelerator.h"
#include "core/render/render_scene.h"
#include "core/render/render_session.h"
#include "core/render/skips.h"
#include "ui/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

std::map<std::string, int> count_by_type(const auto& entries, const auto& member) {
    std::map<std::string, int> counts;
    for (const auto& entry : entries) {
        ++counts[std::visit([](const auto& value) { return std::string(value.kType); }, entry.*member)];
    }
    return counts;
}

/// A mesh of visible objects, and its tree.
struct MeshUse {
    std::string name;  ///< Its file, or the object that brings it.
    const TriangleMesh* mesh = nullptr;
    int instances = 0;
    std::uint64_t tree_bytes = 0;
};

std::string name_of_mesh(const RenderScene& built, std::uint32_t instance) {
    const Object* object = built.scene().find(built.object_id(instance));
    if (!object) return "?";
    const auto* mesh = std::get_if<Mesh>(&object->shape);
    return mesh ? std::filesystem::path(mesh->file).filename().string() : object->name;
}

/// The largest first.
std::vector<MeshUse> meshes_in_use(const RenderScene& built) {
    const auto* kd = dynamic_cast<const KdAccelerator*>(&built.accelerator());
    const std::span<const GeometryInstance> instances = built.accelerator().instances();
    std::vector<MeshUse> meshes;
    std::map<const TriangleMesh*, std::size_t> index;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instances[i].shape);
        if (!mesh) continue;
        const auto [entry, is_new] = index.emplace(mesh->get(), meshes.size());
        if (is_new)
            meshes.push_back({name_of_mesh(built, i), mesh->get(), 0, kd ? kd->mesh_tree(i)->stats.memory_bytes : 0});
        ++meshes[entry->second].instances;
    }
    std::ranges::stable_sort(meshes, std::greater(), [](const MeshUse& use) { return use.mesh->triangles.size(); });
    return meshes;
}

/// To one decimal; `triangles` may be 0.
double bytes_a_triangle(std::uint64_t bytes, std::uint64_t triangles) {
    return triangles > 0 ? std::round(10 * static_cast<double>(bytes) / static_cast<double>(triangles)) / 10 : 0;
}

/// What the meshes of all visible objects hold, each counted once.
nlohmann::ordered_json describe_meshes(const RenderScene& built) {
    constexpr std::size_t kListed = 16;
    const std::vector<MeshUse> meshes = meshes_in_use(built);
    std::uint64_t triangles = 0, positions = 0, normals = 0, uvs = 0, aside = 0, trees = 0;
    auto largest = nlohmann::ordered_json::object();
    for (const MeshUse& use : meshes) {
        const TriangleMesh& mesh = *use.mesh;
        triangles += mesh.triangles.size();
        positions += mesh.positions.size() * sizeof(Vec3);
        normals += mesh.normals.size() * sizeof(Vec3);
        uvs += mesh.has_uvs() ? mesh.positions.size() * sizeof(Vec2) - mesh.bytes_aside() : 0;
        aside += mesh.bytes_aside();
        trees += use.tree_bytes;
        if (largest.size() == kListed || largest.contains(use.name)) continue;
        const std::size_t count = mesh.triangles.size();
        largest[use.name] = {{"triangles", count},
                             {"instances", use.instances},
                             {"bytes_a_triangle",
                              {{"mesh", bytes_a_triangle(mesh.memory_bytes(), count)},
                               {"tree", bytes_a_triangle(use.tree_bytes, count)}}}};
    }
    const auto each = [&](std::uint64_t bytes) { return bytes_a_triangle(bytes, triangles); };
    return {{"count", meshes.size()},
            {"triangles", triangles},
            {"bytes_a_triangle",
             {{"indices", each(triangles * sizeof(glm::uvec3))},
              {"positions", each(positions)},
              {"normals", each(normals)},
              {"uvs", each(uvs)},
              {"uvs_aside", each(aside)},
              {"trees", each(trees)}}},
            {"largest", std::move(largest)}};
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
        {"meshes", describe_meshes(built)},
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
          {"bytes_a_primitive", std::round(10 * static_cast<double>(accel.memory_bytes) / primitives) / 10}}},
        {"memory_bytes",
         {{"surfaces", built.surfaces().memory_bytes()},
          {"lights", built.lights().memory_bytes()},
          {"all", built.memory_bytes()}}}};
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
