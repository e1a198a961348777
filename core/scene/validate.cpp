#include "core/scene/validate.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace {

void append(Problems& to, Problems from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

template <typename Variant>
Problems check_variant_fields(const Variant& variant, const std::string& place) {
    return std::visit([&](const auto& value) { return check_fields(value, place); }, variant);
}

template <typename T>
std::optional<std::string> check_member(const T& value, const SettingField& field) {
    if constexpr (NamedEnum<T>) {
        if (static_cast<std::size_t>(value) >= kEnumNames<T>.size()) return "is none of the known values";
        return std::nullopt;
    } else {
        return check_setting(static_cast<double>(value), field);
    }
}

template <typename T>
std::optional<std::string> check_member(const std::optional<T>& value, const SettingField& field) {
    return value ? check_member(*value, field) : std::nullopt;
}

bool is_unit(const Quat& q) {
    // What a float quaternion keeps of unit length over a few operations.
    return std::abs(glm::dot(q, q) - 1) < 1e-4f;
}

}  // namespace

std::optional<std::string> check_field(float value, const Field& field) {
    if (!std::isfinite(value)) return fmt::format("must be a finite number, is {}", value);
    if (field.min_excluded && !(value > field.min)) return fmt::format("must be > {}, is {}", field.min, value);
    if (!(value >= field.min)) return fmt::format("must be >= {}, is {}", field.min, value);
    if (!(value <= field.max)) return fmt::format("must be <= {}, is {}", field.max, value);
    return std::nullopt;
}

std::optional<std::string> check_field(const Vec3& value, const Field& field) {
    for (int axis = 0; axis < 3; ++axis) {
        if (auto cause = check_field(value[axis], field)) return cause;
    }
    if (field.role == FieldRole::direction && value == Vec3(0)) return "must not be zero";
    return std::nullopt;
}

std::optional<std::string> check_field(const std::array<Vec3, 3>& value, const Field& field) {
    for (const Vec3& vector : value) {
        if (auto cause = check_field(vector, field)) return cause;
    }
    return std::nullopt;
}

std::optional<std::string> check_field(const ColorValue& value, const Field& field) {
    return check_field(value.value, field);
}

std::optional<std::string> check_field(const FloatValue& value, const Field& field) {
    if (value.channel < 0 || value.channel > 3) return fmt::format("has no channel {}", value.channel);
    return check_field(value.value, field);
}

std::optional<std::string> check_setting(double value, const SettingField& field) {
    if (!std::isfinite(value)) return fmt::format("must be a finite number, is {}", value);
    if (value < field.min) return fmt::format("must be >= {}, is {}", field.min, value);
    if (value > field.max) return fmt::format("must be <= {}, is {}", field.max, value);
    return std::nullopt;
}

std::string join_place(std::string_view place, std::string_view key) {
    if (place.empty() || key.empty()) return std::string(place.empty() ? key : place);
    return fmt::format("{}.{}", place, key);
}

Problems check_shape(const Shape& shape, const std::string& place) {
    Problems problems = check_variant_fields(shape, place);
    if (!problems.empty()) return problems;
    if (const auto* box = std::get_if<Box>(&shape)) {
        for (int axis = 0; axis < 3; ++axis) {
            if (box->min[axis] <= box->max[axis]) continue;
            problems.push_back(
                {"", join_place(place, "min"),
                 fmt::format("must be <= max in {}, is {} > {}", "xyz"[axis], box -> min[axis], box -> max[axis])});
        }
    }
    return problems;
}

Problems check_material(const Material& material, const std::string& place) {
    return check_variant_fields(material, place);
}

Problems check_environment(const Environment& environment, const std::string& place) {
    return check_variant_fields(environment, place);
}

Problems check_camera(const Camera& camera, const std::string& place) {
    Problems problems = check_fields(camera, place);
    if (camera.position == camera.target) {
        problems.push_back({"", join_place(place, "target"), "must differ from the position"});
    }
    return problems;
}

Problems check_film(const FilmSettings& film, const std::string& place) {
    Problems problems;
    visit_film_fields(film, [&](const auto& member, const SettingField& field) {
        if (auto cause = check_member(member, field)) problems.push_back({"", join_place(place, field.key), *cause});
    });
    return problems;
}

Problems check_render_settings(const RenderSettings& render, const std::string& place) {
    Problems problems;
    visit_render_fields(render, [&](const auto& member, const SettingField& field) {
        if (auto cause = check_member(member, field)) problems.push_back({"", join_place(place, field.key), *cause});
    });
    return problems;
}

Problems check_transform(const Transform& transform, const Shape& shape, const std::string& place) {
    const auto problem = [&](std::string_view key, std::string cause) {
        return Problems{{"", join_place(place, key), std::move(cause)}};
    };
    const bool is_plane = std::holds_alternative<Plane>(shape);
    if (transform.matrix) {
        if (is_plane) return problem("matrix", "a plane takes rotation and translation only");
        const Mat4& m = *transform.matrix;
        for (int column = 0; column < 4; ++column) {
            if (!is_finite(Vec3(m[column]))) return problem("matrix", "must be finite numbers");
        }
        if (glm::transpose(m)[3] != Vec4(0, 0, 0, 1)) return problem("matrix", "its last row must be 0 0 0 1");
        if (!transform.affine().is_invertible()) return problem("matrix", "must be invertible");
        return {};
    }
    if (!is_finite(transform.translate)) return problem("translate", "must be finite numbers");
    if (!is_unit(transform.rotate)) return problem("rotate", "must be a unit quaternion");
    if (!is_finite(transform.scale)) return problem("scale", "must be finite numbers");
    if (is_plane && transform.scale != Vec3(1)) return problem("scale", "a plane takes rotation and translation only");
    if (!transform.affine().is_invertible()) return problem("scale", "must not be 0");
    return {};
}

namespace {

void check_materials(const Scene& scene, Problems& problems) {
    std::unordered_set<std::uint32_t> ids;
    std::unordered_set<std::string_view> names;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const MaterialEntry& entry = scene.materials[i];
        const std::string place = fmt::format("materials[{}]", i);
        if (!entry.id || entry.id.value >= scene.next_id) problems.push_back({"", place, "has an id out of range"});
        if (!ids.insert(entry.id.value).second) problems.push_back({"", place, "has the id of another material"});
        if (entry.name.empty()) problems.push_back({"", place, "has no name"});
        if (!names.insert(entry.name).second) problems.push_back({"", place, "has the name of another: " + entry.name});
        append(problems, check_material(entry.material, place));
    }
}

void check_objects(const Scene& scene, Problems& problems) {
    std::unordered_set<std::uint32_t> materials;
    for (const MaterialEntry& entry : scene.materials) materials.insert(entry.id.value);
    std::unordered_map<std::uint32_t, bool> is_list;  // Of the objects so far.
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        const std::string place = fmt::format("objects[{}]", i);
        if (!object.id || object.id.value >= scene.next_id || materials.contains(object.id.value)) {
            problems.push_back({"", place, "has an id out of range"});
        }
        if (object.parent) {
            // Parents come before their children, so a cycle cannot pass.
            const auto parent = is_list.find(object.parent.value);
            if (parent == is_list.end()) problems.push_back({"", place + ".parent", "does not stand before it"});
            if (parent != is_list.end() && !parent->second) problems.push_back({"", place + ".parent", "is no list"});
        }
        if (!is_list.emplace(object.id.value, std::holds_alternative<ObjectList>(object.shape)).second) {
            problems.push_back({"", place, "has the id of another object"});
        }
        if (object.material && !materials.contains(object.material.value)) {
            problems.push_back({"", place + ".material", "does not exist"});
        }
        if (const auto* gltf = std::get_if<Gltf>(&object.shape)) {
            for (const MaterialId id : gltf->materials) {
                if (id && !materials.contains(id.value))
                    problems.push_back({"", place, "uses a material that does not exist"});
            }
        }
        append(problems, check_shape(object.shape, place));
        append(problems, check_transform(object.transform, object.shape, place + ".transform"));
    }
}

}  // namespace

Problems validate(const Scene& scene) {
    Problems problems = check_film(scene.film, "film");
    append(problems, check_camera(scene.camera, "camera"));
    append(problems, check_environment(scene.environment, "environment"));
    append(problems, check_render_settings(scene.render, "render"));
    check_materials(scene, problems);
    check_objects(scene, problems);
    return problems;
}

}  // namespace rayuela
