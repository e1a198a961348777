#pragma once

#include "core/materials/value.h"
#include "core/math/field.h"
#include "core/math/result.h"
#include "core/scene/scene.h"
#include "core/scene/settings_fields.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace rayuela {

/// What is wrong with the value of a member, by its Field ("must be > 0, is -1"); nothing where it is right.
/// Numbers must be finite and in range, directions not zero.
std::optional<std::string> check_field(float value, const Field& field);
std::optional<std::string> check_field(const Vec3& value, const Field& field);
std::optional<std::string> check_field(const std::array<Vec3, 3>& value, const Field& field);
std::optional<std::string> check_field(const ColorValue& value, const Field& field);
std::optional<std::string> check_field(const FloatValue& value, const Field& field);
inline std::optional<std::string> check_field(bool, const Field&) {
    return std::nullopt;
}
inline std::optional<std::string> check_field(const std::string&, const Field&) {
    return std::nullopt;
}

/// A setting against its range; enumerations must be one of their names.
std::optional<std::string> check_setting(double value, const SettingField& field);

/// "place.key", or the one that is not empty.
std::string join_place(std::string_view place, std::string_view key);

/// Every member of a struct with visit_fields against its Field; places are `place`.key.
template <typename T>
Problems check_fields(const T& value, const std::string& place) {
    Problems problems;
    T::visit_fields(value, [&](const auto& member, const Field& field) {
        if (auto cause = check_field(member, field)) problems.push_back({"", join_place(place, field.key), *cause});
    });
    return problems;
}

/// The rules that involve several members, such as a box's min <= max, besides those of check_fields.
Problems check_shape(const Shape& shape, const std::string& place);
Problems check_material(const Material& material, const std::string& place);
Problems check_environment(const Environment& environment, const std::string& place);
Problems check_camera(const Camera& camera, const std::string& place);
Problems check_film(const FilmSettings& film, const std::string& place);
Problems check_render_settings(const RenderSettings& render, const std::string& place);
/// Finite, invertible, a unit rotation; of a plane also rigid.
Problems check_transform(const Transform& transform, const Shape& shape, const std::string& place);

/// `name`, or name with the lowest number from 2 on ("Sphere 2") that `is_taken` does not know.
template <typename IsTaken>
std::string unique_name(std::string_view name, const IsTaken& is_taken) {
    std::string_view base = name;
    while (!base.empty() && base.back() >= '0' && base.back() <= '9') base.remove_suffix(1);
    const bool numbered = base.size() < name.size() && base.size() > 1 && base.back() == ' ';
    base = numbered ? base.substr(0, base.size() - 1) : name;
    std::string candidate(name);
    for (int number = 2; is_taken(candidate); ++number) candidate = std::string(base) + " " + std::to_string(number);
    return candidate;
}

}  // namespace rayuela
