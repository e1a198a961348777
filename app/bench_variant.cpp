#include "app/bench_variant.h"

#include "core/scene/scene_edit.h"
#include "core/scene/settings_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <concepts>

namespace rayuela {

namespace {

bool parse(std::string_view text, auto& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

bool parse(std::string_view text, bool& value) {
    value = text == "true";
    return value || text == "false";
}

template <NamedEnum T>
bool parse(std::string_view text, T& value) {
    const auto found = std::ranges::find(kEnumNames<T>, text);
    value = static_cast<T>(found - kEnumNames<T>.begin());
    return found != kEnumNames<T>.end();
}

template <typename T>
bool parse(std::string_view text, std::optional<T>& value) {
    return parse(text, value.emplace());
}

/// Calls visit(name, value) for everything that can be set: the scene's render settings, parts of the algorithm, and how a
/// session samples.
template <typename Visitor>
void visit_settings(RenderSettings& render, VariantScene& variant, const Visitor& visit) {
    PathTracerOptions& options = variant.options;
    visit_render_fields(render, [&](auto& value, const SettingField& field) { visit(field.key, value); });
    visit("light_sampling", options.light_sampling);
    visit("light_tracing", options.light_tracing);
    visit("mis", options.mis);
    visit("russian_roulette", options.russian_roulette);
    for (const ShortcutField& shortcut : kShortcuts) visit(shortcut.key, options.shortcuts.*shortcut.member);
    visit("target_error", variant.sampling.target_error);
    visit("clamp", variant.sampling.clamp);
}

Result<void> apply_setting(const std::string& setting, RenderSettings& render, VariantScene& variant) {
    const std::size_t equals = std::min(setting.find('='), setting.size());
    const std::string_view name = std::string_view(setting).substr(0, equals);
    const std::string_view text = std::string_view(setting).substr(std::min(equals + 1, setting.size()));
    bool known = false, understood = true;
    visit_settings(render, variant, [&](std::string_view key, auto& value) {
        if (key != name) return;
        known = true;
        understood = parse(text, value);
    });
    if (!known) {
        return fail("", setting,
                    fmt::format("no setting \"{}\"; there are {}", name, fmt::join(setting_names(), ", ")));
    }
    const auto& [target_error, clamp] = variant.sampling;
    understood = understood && target_error >= 0 && target_error <= double{kMaxTargetError} && clamp >= 0;
    if (!understood) return fail("", setting, fmt::format("{} cannot be \"{}\"", name, text));
    return {};
}

std::vector<std::string> split(std::string_view list) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        parts.emplace_back(list.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

}  // namespace

std::vector<std::string> setting_names() {
    RenderSettings render;
    VariantScene variant;
    std::vector<std::string> names;
    visit_settings(render, variant, [&](std::string_view name, const auto&) { names.emplace_back(name); });
    return names;
}

Result<std::vector<BenchVariant>> make_variants(const std::vector<std::string>& set,
                                                const std::vector<std::string>& compare) {
    if (compare.empty()) return std::vector<BenchVariant>{{fmt::format("{}", fmt::join(set, " ")), set}};
    std::vector<BenchVariant> variants;
    for (const std::string& group : compare) {
        const std::size_t equals = group.find('=');
        if (equals == std::string::npos) return fail("", group, "must be NAME=VALUE,VALUE...");
        const std::size_t base = variants.size();
        for (const std::string& value : split(std::string_view(group).substr(equals + 1))) {
            BenchVariant variant{fmt::format("{}={}", group.substr(0, equals), value), set, base};
            variant.settings.push_back(variant.name);
            variants.push_back(std::move(variant));
        }
    }
    return variants;
}

Result<VariantScene> apply_settings(const Scene& scene, const std::vector<std::string>& settings) {
    VariantScene result;
    RenderSettings render = scene.render;
    for (const std::string& setting : settings) {
        if (auto done = apply_setting(setting, render, result); !done) return tl::unexpected(done.error());
    }
    auto applied = apply(scene, SetRenderSettings{render});
    if (!applied) return tl::unexpected(applied.error());
    result.scene = std::move(*applied);
    return result;
}

}  // namespace rayuela
