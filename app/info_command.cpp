#include "app/subcommands.h"
#include "core/render/render_scene.h"

#include <fmt/format.h>

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

nlohmann::ordered_json describe(const Scene& scene, const AccelStats& accel, std::size_t lights) {
    const Bounds3 bounds = world_bounds(scene);
    nlohmann::ordered_json info = {
        {"film", {{"width", scene.film.width}, {"height", scene.film.height}}},
        {"objects", count_by_type(scene.objects, &Object::shape)},
        {"materials", count_by_type(scene.materials, &MaterialEntry::material)},
        {"environment", std::visit([](const auto& e) { return e.kType; }, scene.environment)},
        {"lights", lights},
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
          {"memory_bytes", accel.memory_bytes}}}};
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

}  // namespace

Result<void> run_info(const InfoOptions& options) {
    auto scene = load_scene(options.scene);
    if (!scene) return tl::unexpected(scene.error());
    BuildControl control;
    const auto shared = std::make_shared<const Scene>(std::move(*scene));
    const auto built = RenderScene::update(nullptr, shared, all_changes(), control);
    const auto info = describe(*shared, built->accelerator().stats(), built->lights().size());
    if (options.json) {
        fmt::print("{}\n", info.dump(2));
    } else {
        print(info);
    }
    return {};
}

}  // namespace rayuela
