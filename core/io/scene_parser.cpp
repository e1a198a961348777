#include "core/io/scene_parser.h"

#include "core/io/object_names.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

/// Calls visit with a default-constructed value of each alternative of the variant.
template <typename Variant, typename Visit, std::size_t... I>
void for_each_alternative(const Visit& visit, std::index_sequence<I...>) {
    (visit(std::variant_alternative_t<I, Variant>{}), ...);
}

template <typename Variant, typename Visit>
void for_each_alternative(const Visit& visit) {
    for_each_alternative<Variant>(visit, std::make_index_sequence<std::variant_size_v<Variant>>());
}

}  // namespace

Result<LoadedScene> SceneParser::run(const Json& json) {
    JsonObject root(json, "", problems_);
    if (!problems_.problems.empty()) return tl::unexpected(problems_.problems);
    const Json* version = root.take("rayuela");
    const double* number = version ? version->get<double>() : nullptr;
    if (!number || *number != kSceneFormatVersion) {
        const std::string found = !version ? "missing"
                                  : number ? fmt::to_string(*number)
                                           : std::string(version->type_name());
        problems_.add("rayuela", fmt::format("the format version must be {}, is {}", kSceneFormatVersion, found));
        return tl::unexpected(problems_.problems);
    }
    const auto part = [&](const char* key, void (SceneParser::*read)(const Json&)) {
        if (const Json* value = root.take(key)) (this->*read)(*value);
    };
    part("film", &SceneParser::film);
    part("camera", &SceneParser::camera);
    part("environment", &SceneParser::environment);
    part("materials", &SceneParser::materials);
    if (const Json* list = root.take("objects")) objects(*list, "objects", {});
    part("render", &SceneParser::render);
    root.finish();
    resolve_materials();
    if (!problems_.problems.empty()) return tl::unexpected(problems_.problems);
    name_objects();
    return LoadedScene{std::move(scene_), std::move(warnings_)};
}

void SceneParser::film(const Json& json) {
    JsonObject object(json, "film", problems_);
    visit_film_fields(scene_.film, [&](auto& value, const SettingField& field) { setting(object, value, field); });
    object.finish();
}

void SceneParser::render(const Json& json) {
    JsonObject object(json, "render", problems_);
    visit_render_fields(scene_.render, [&](auto& value, const SettingField& field) { setting(object, value, field); });
    object.finish();
}

void SceneParser::camera(const Json& json) {
    const std::size_t before = problems_.problems.size();
    JsonObject object(json, "camera", problems_);
    fields(object, scene_.camera);
    object.finish();
    if (problems_.problems.size() == before) problems_.add(check_camera(scene_.camera, "camera"));
}

void SceneParser::environment(const Json& json) {
    if (json.get<std::nullptr_t>()) {
        scene_.environment = NoEnvironment{};
        return;
    }
    JsonObject object(json, "environment", problems_);
    if (!choose_type(object, scene_.environment)) return;
    std::visit(
        [&](auto& environment) {
            fields(object, environment);
            load(environment, object);
        },
        scene_.environment);
    object.finish();
}

void SceneParser::materials(const Json& json) {
    const auto* list = json.get<Json::Object>();
    if (!list) return tell_type(problems_, "materials", "an object", json);
    for (const auto& [name, value] : *list) {
        const std::string place = "materials." + name;
        if (name.empty()) problems_.add(place, "a material must have a name");
        JsonObject object(value, place, problems_);
        Material material;
        if (choose_type(object, material)) {
            std::visit([&](auto& chosen) { fields(object, chosen); }, material);
            object.finish();
        }
        add_material(name, material);
    }
}

void SceneParser::objects(const Json& json, const std::string& place, ObjectId parent) {
    const auto* list = json.get<Json::Array>();
    if (!list) return tell_type(problems_, place, "an array", json);
    for (std::size_t i = 0; i < list->size(); ++i) object((*list)[i], fmt::format("{}[{}]", place, i), parent);
}

void SceneParser::object(const Json& json, const std::string& place, ObjectId parent) {
    const std::size_t before = problems_.problems.size();
    JsonObject members(json, place, problems_);
    Object result;
    if (!choose_type(members, result.shape)) return;
    result.id = ObjectId{scene_.next_id++};
    result.parent = parent;
    if (const auto* name = members.take_as<std::string>("name", "a text")) result.name = *name;
    if (const Json* material = members.take("material")) use_material(*material, members.place("material"));
    if (const bool* visible = members.take_as<bool>("visible", "true or false")) result.visible = *visible;
    const Json* placed = members.take("transform");
    std::visit(
        [&](auto& shape) {
            fields(members, shape);
            load(shape, members);
        },
        result.shape);
    if (placed) result.transform = read_transform(*placed, result.shape, members.place("transform"), problems_);
    if (problems_.problems.size() == before) problems_.add(check_shape(result.shape, place));
    const ObjectId id = result.id;
    const bool is_list = std::holds_alternative<ObjectList>(result.shape);
    scene_.objects.push_back(std::move(result));
    if (is_list) {
        if (const Json* children = members.take("objects")) objects(*children, members.place("objects"), id);
    }
    members.finish();
}

void SceneParser::use_material(const Json& json, const std::string& place, std::optional<std::size_t> slot) {
    const auto* name = json.get<std::string>();
    if (!name) return tell_type(problems_, place, "the name of a material", json);
    material_uses_.push_back({scene_.objects.size(), slot, *name, place});
}

void SceneParser::resolve_materials() {
    for (const MaterialUse& use : material_uses_) {
        const auto found = material_ids_.find(use.name);
        if (found == material_ids_.end()) {
            problems_.add(use.place, fmt::format("there is no material '{}'", use.name));
        } else if (problems_.problems.empty()) {
            Object& object = scene_.objects[use.object];
            (use.slot ? std::get<Gltf>(object.shape).materials[*use.slot] : object.material) = found->second;
        }
    }
}

MaterialId SceneParser::add_material(const std::string& name, const Material& material) {
    const MaterialId id{scene_.next_id++};
    scene_.materials.push_back({id, name, material});
    return material_ids_[name] = id;
}

void SceneParser::gltf_materials(Gltf& gltf, const GltfFile& file, const Json* names, const std::string& place) {
    const auto* given = names ? names->get<Json::Array>() : nullptr;
    if (names && (!given || given->size() != file.materials.size())) {
        return problems_.add(place, fmt::format("must be an array of {} names", file.materials.size()));
    }
    const std::string prefix = gltf_names_.prefix(gltf.file);
    gltf.materials.resize(file.materials.size());
    for (std::size_t i = 0; i < file.materials.size(); ++i) {
        const std::string own = prefix + file.materials[i].name;
        const Json* name = given ? &(*given)[i] : nullptr;
        if (name && name->get<std::nullptr_t>()) continue;
        if (name && !(name->get<std::string>() && *name->get<std::string>() == own)) {
            use_material(*name, fmt::format("{}[{}]", place, i), i);
            continue;
        }
        const auto known = material_ids_.find(own);
        gltf.materials[i] =
            known != material_ids_.end() ? known->second : add_material(own, file.materials[i].material);
    }
}

void SceneParser::name_objects() {
    std::vector<ObjectName> names;
    for (const Object& object : scene_.objects) {
        names.push_back({std::visit([](const auto& shape) { return shape.kLabel; }, object.shape), object.name});
    }
    fill_in_names(names);
    for (std::size_t i = 0; i < names.size(); ++i) scene_.objects[i].name = std::move(names[i].name);
}

template <typename Variant>
bool SceneParser::choose_type(JsonObject& object, Variant& variant) {
    const std::size_t before = problems_.problems.size();
    const auto* type = object.take_as<std::string>("type", "a text");
    bool found = false;
    std::string known;
    for_each_alternative<Variant>([&](auto alternative) {
        known += (known.empty() ? "" : ", ") + std::string(alternative.kType);
        if (!type || *type != alternative.kType) return;
        variant = alternative;
        found = true;
    });
    if (!found && problems_.problems.size() == before) {
        problems_.add(object.place("type"), type ? fmt::format("'{}' is unknown; known are {}", *type, known)
                                                 : "is missing; known are " + known);
    }
    return found;
}

template <typename T>
void SceneParser::fields(JsonObject& object, T& value) {
    T::visit_fields(value, [&](auto& slot, const Field& field) {
        const std::size_t before = problems_.problems.size();
        if (const Json* json = object.take(field.key)) {
            member(*json, object.place(field.key), field, slot);
        } else if (field.role == FieldRole::file) {
            problems_.add(object.place(field.key), "is missing");
        }
        if (problems_.problems.size() > before) return;
        if (auto cause = check_field(slot, field)) problems_.add(object.place(field.key), *cause);
    });
}

namespace {

template <typename T>
void read_setting(const Json& json, const std::string& place, const SettingField& field, ProblemList& problems,
                  T& value) {
    if constexpr (NamedEnum<T>) {
        const auto* name = json.get<std::string>();
        const auto& names = kEnumNames<T>;
        const auto found = name ? std::ranges::find(names, *name) : names.end();
        if (found != names.end()) {
            value = static_cast<T>(found - names.begin());
        } else if (name) {
            problems.add(place, fmt::format("'{}' is unknown; known are {}", *name, fmt::join(names, ", ")));
        } else {
            tell_type(problems, place, "a text", json);
        }
    } else {
        const double* number = json.get<double>();
        if (!number) return tell_type(problems, place, "a number", json);
        if (auto cause = check_setting(*number, field)) return problems.add(place, *cause);
        if (std::is_integral_v<T> && *number != std::floor(*number)) {
            return problems.add(place, fmt::format("must be a whole number, is {}", *number));
        }
        value = static_cast<T>(*number);
    }
}

template <typename T>
void read_setting(const Json& json, const std::string& place, const SettingField& field, ProblemList& problems,
                  std::optional<T>& value) {
    T read{};
    read_setting(json, place, field, problems, read);
    value = read;
}

}  // namespace

template <typename T>
void SceneParser::setting(JsonObject& object, T& value, const SettingField& field) {
    if (const Json* json = object.take(field.key))
        read_setting(*json, object.place(field.key), field, problems_, value);
}

void SceneParser::member(const Json& json, const std::string& place, const Field&, float& value) {
    if (const auto number = read_float(json, place, problems_)) value = *number;
}

void SceneParser::member(const Json& json, const std::string& place, const Field&, bool& value) {
    if (const bool* flag = json.get<bool>()) {
        value = *flag;
    } else {
        tell_type(problems_, place, "true or false", json);
    }
}

void SceneParser::member(const Json& json, const std::string& place, const Field& field, std::string& value) {
    const auto* text = json.get<std::string>();
    if (!text) return tell_type(problems_, place, "a text", json);
    if (field.role == FieldRole::file && text->empty()) return problems_.add(place, "must name a file");
    value = field.role == FieldRole::file ? absolute(*text) : *text;
}

void SceneParser::member(const Json& json, const std::string& place, const Field& field, Vec3& value) {
    const bool is_color = field.role == FieldRole::reflectance || field.role == FieldRole::radiance;
    const auto vec = is_color ? read_color(json, place, problems_) : read_vec3(json, place, problems_);
    if (vec) value = *vec;
}

void SceneParser::member(const Json& json, const std::string& place, const Field&, std::array<Vec3, 3>& value) {
    const auto* list = json.get<Json::Array>();
    if (!list || list->size() != value.size()) {
        return problems_.add(place, fmt::format("must be {} points of 3 numbers each", value.size()));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
        if (const auto vec = read_vec3((*list)[i], fmt::format("{}[{}]", place, i), problems_)) value[i] = *vec;
    }
}

void SceneParser::member(const Json& json, const std::string& place, const Field& field, ColorValue& value) {
    if (!json.get<Json::Object>()) return member(json, place, field, value.value);
    JsonObject object(json, place, problems_);
    value.value = Color(1);
    value.texture = texture(object, ColorDecoding::srgb);
    if (const Json* factor = object.take("factor")) member(*factor, object.place("factor"), field, value.value);
    object.finish();
}

void SceneParser::member(const Json& json, const std::string& place, const Field& field, FloatValue& value) {
    if (!json.get<Json::Object>()) return member(json, place, field, value.value);
    JsonObject object(json, place, problems_);
    value.value = 1;
    value.texture = texture(object, ColorDecoding::linear);
    if (const Json* factor = object.take("factor")) member(*factor, object.place("factor"), field, value.value);
    if (const auto* channel = object.take_as<std::string>("channel", "a text")) {
        const std::size_t index =
            channel->size() == 1 ? std::string_view("rgba").find(*channel) : std::string_view::npos;
        if (index == std::string_view::npos) {
            problems_.add(object.place("channel"), fmt::format("'{}' is unknown; known are r, g, b, a", *channel));
        } else {
            value.channel = static_cast<int>(index);
        }
    }
    object.finish();
}

std::shared_ptr<const Image> SceneParser::texture(JsonObject& object, ColorDecoding decoding) {
    const Json* json = object.take("texture");
    const auto* file = json ? json->get<std::string>() : nullptr;
    if (!json) problems_.add(object.place("texture"), "is missing");
    if (json && !file) tell_type(problems_, object.place("texture"), "a text", *json);
    if (!file) return nullptr;
    auto image = cache_.image(absolute(*file), decoding, &warnings_);
    if (image) return *image;
    tell(image.error(), object.place("texture"));
    return nullptr;
}

void SceneParser::load(Mesh& mesh, JsonObject& object) {
    if (mesh.file.empty()) return;
    if (auto data = cache_.mesh(mesh.file, &warnings_)) {
        mesh.data = *data;
    } else {
        tell(data.error(), object.place("file"));
    }
}

void SceneParser::load(Gltf& gltf, JsonObject& object) {
    const Json* names = object.take("materials");
    if (gltf.file.empty()) return;
    const auto file = cache_.gltf(gltf.file);
    if (!file) return tell(file.error(), object.place("file"));
    gltf.geometry = (*file)->geometry;
    gltf_materials(gltf, **file, names, object.place("materials"));
    warnings_.insert(warnings_.end(), (*file)->warnings.begin(), (*file)->warnings.end());
}

void SceneParser::load(ImageEnvironment& environment, JsonObject& object) {
    if (environment.file.empty()) return;
    // A picture that is no panorama of floats is taken for what it shows.
    if (auto image = cache_.panorama(environment.file, ColorDecoding::srgb, &warnings_)) {
        environment.image = *image;
    } else {
        tell(image.error(), object.place("file"));
    }
}

void SceneParser::tell(const Problems& problems, const std::string& place) {
    for (const Problem& problem : problems) problems_.add(place, problem.message());
}

std::string SceneParser::absolute(const std::string& file) const {
    return (base_ / file).lexically_normal().string();
}

}  // namespace rayuela
