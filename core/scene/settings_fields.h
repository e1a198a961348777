#pragma once

#include "core/scene/scene.h"

#include <array>
#include <string_view>

namespace rayuela {

/// Names of the values of an enumeration, in their order, as the scene file and the command line have them.
template <typename Enum>
inline constexpr std::array<std::string_view, 0> kEnumNames{};
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<PixelFilter>{"box", "tent", "gaussian"};
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<SamplerKind>{"independent", "sobol"};
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<LightChoice>{"uniform", "power", "arriving"};
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<AcceleratorKind>{"list", "kd"};
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<KdSplit>{"median", "sah"};

/// Whether T has a list of names.
template <typename T>
concept NamedEnum = kEnumNames<T>
.size() > 0;

/// A member of FilmSettings or RenderSettings: its key and, of a number, its range. Bounds are doubles so that every
/// integer is exact.
struct SettingField {
    std::string_view key;
    double min = 0;
    double max = std::numeric_limits<double>::infinity();
};

/// As visit_fields of a shape: the scene file and validation loop over these lists.
template <typename Self, typename Visitor>
void visit_film_fields(Self& film, Visitor&& visit) {
    visit(film.width, SettingField{"width", 1, kMaxFilmSide});
    visit(film.height, SettingField{"height", 1, kMaxFilmSide});
    visit(film.filter, SettingField{"filter"});
}

inline constexpr int kMaxBounces = 1 << 20;

template <typename Self, typename Visitor>
void visit_render_fields(Self& render, Visitor&& visit) {
    visit(render.max_bounces, SettingField{"max_bounces", 0, kMaxBounces});
    visit(render.rr_start, SettingField{"rr_start", 0, kMaxBounces});
    visit(render.accel.kind, SettingField{"accelerator"});
    visit(render.accel.leaf_size, SettingField{"kd_leaf_size", kMinLeafSize, kMaxLeafSize});
    visit(render.accel.split, SettingField{"kd_split"});
    visit(render.sampler, SettingField{"sampler"});
    visit(render.light_choice, SettingField{"light_choice"});
    visit(render.seed, SettingField{"seed", 0, 4294967295.0});
    visit(render.max_samples, SettingField{"max_samples", 0, 2147483647.0});
    visit(render.max_seconds, SettingField{"max_seconds"});
}

}  // namespace rayuela
