#include "core/io/scene_writer.h"

#include "core/io/file_bytes.h"
#include "core/io/gltf_names.h"
#include "core/io/json.h"
#include "core/io/object_names.h"
#include "core/io/scene_parser.h"
#include "core/scene/scene_edit.h"
#include "core/scene/settings_fields.h"
#include "core/scene/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace fs = std::filesystem;

namespace {

/// Equal including the sign of zero, so that leaving out a default loses nothing.
bool same(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}
bool same(const Vec3& a, const Vec3& b) {
    return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}
bool same(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]);
}
bool same(const ColorValue& a, const ColorValue& b) {
    return same(a.value, b.value) && a.texture == b.texture;
}
bool same(const FloatValue& a, const FloatValue& b) {
    return same(a.value, b.value) && a.texture == b.texture;
}
template <typename T>
bool same(const T& a, const T& b) {
    return a == b;
}

/// Makes the JSON of a scene; what cannot be written is collected.
class SceneWriter {
public:
    SceneWriter(const Scene& scene, const fs::path& base, AssetCache& cache)
        : scene_(scene), base_(base), cache_(cache), gltf_names_(scene) {
        for (const MaterialEntry& entry : scene.materials) material_names_.emplace(entry.id.value, &entry.name);
        for (const Object& object : scene.objects) children_[object.parent.value].push_back(&object);
    }

    Result<std::string> run() {
        const Scene standard;
        Json::Object root{{"rayuela", static_cast<double>(kSceneFormatVersion)}};
        const auto add = [&](const char* key, Json::Object members) {
            if (!members.empty()) root.emplace_back(key, std::move(members));
        };
        Json::Object film, render;
        visit_both_settings(scene_.film, standard.film, film, [](auto& s, auto&& v) { visit_film_fields(s, v); });
        visit_both_settings(scene_.render, standard.render, render,
                            [](auto& s, auto&& v) { visit_render_fields(s, v); });
        add("film", std::move(film));
        add("camera", fields(scene_.camera, "camera"));
        if (!std::holds_alternative<NoEnvironment>(scene_.environment)) {
            add("environment", variant(scene_.environment, "environment"));
        }
        leave_out_names();
        Json::Array list = objects(ObjectId{});
        add("materials", materials());
        if (!list.empty()) root.emplace_back("objects", std::move(list));
        add("render", std::move(render));
        if (!problems_.empty()) return tl::unexpected(std::move(problems_));
        return to_text(root);
    }

private:
    /// Members of `settings` that differ from the default, in the order of their list.
    template <typename T, typename VisitFields>
    void visit_both_settings(const T& settings, const T& standard, Json::Object& members,
                             const VisitFields& visit_fields) {
        std::vector<Json> defaults;
        visit_fields(standard, [&](const auto& value, const SettingField&) { defaults.push_back(setting(value)); });
        std::size_t index = 0;
        visit_fields(settings, [&](const auto& value, const SettingField& field) {
            Json json = setting(value);
            if (json.value != defaults[index++].value) members.emplace_back(field.key, std::move(json));
        });
    }

    template <typename T>
    static Json setting(const T& value) {
        if constexpr (NamedEnum<T>)
            return std::string(kEnumNames<T>[static_cast<std::size_t>(value)]);
        else
            return static_cast<double>(value);
    }
    template <typename T>
    static Json setting(const std::optional<T>& value) {
        return value ? setting(*value) : Json();
    }

    template <typename T>
    Json::Object fields(const T& value, const std::string& place) {
        const T standard;
        Json::Object members;
        // The same member of both is the one with the same key.
        T::visit_fields(value, [&](const auto& member, const Field& field) {
            T::visit_fields(standard, [&](const auto& other, const Field& other_field) {
                if constexpr (std::is_same_v<decltype(member), decltype(other)>) {
                    if (field.key != other_field.key || same(member, other)) return;
                    members.emplace_back(field.key, write(member, other, field, join_place(place, field.key)));
                }
            });
        });
        return members;
    }

    template <typename Variant>
    Json::Object variant(const Variant& value, const std::string& place) {
        return std::visit(
            [&](const auto& v) {
                Json::Object members{{"type", std::string(v.kType)}};
                Json::Object more = fields(v, place);
                members.insert(members.end(), more.begin(), more.end());
                return members;
            },
            value);
    }

    static Json vec(const Vec3& v) { return Json::Array{v.x, v.y, v.z}; }

    Json write(float value, float, const Field&, const std::string&) { return value; }
    Json write(bool value, bool, const Field&, const std::string&) { return value; }
    Json write(const Vec3& value, const Vec3&, const Field&, const std::string&) { return vec(value); }
    Json write(const std::array<Vec3, 3>& value, const std::array<Vec3, 3>&, const Field&, const std::string&) {
        return Json::Array{vec(value[0]), vec(value[1]), vec(value[2])};
    }
    Json write(const std::string& value, const std::string&, const Field& field, const std::string&) {
        return field.role == FieldRole::file ? relative(value) : value;
    }
    Json write(const ColorValue& value, const ColorValue&, const Field&, const std::string& place) {
        if (!value.texture) return vec(value.value);
        Json::Object members{{"texture", texture(*value.texture, place)}};
        if (!same(value.value, Color(1))) members.emplace_back("factor", vec(value.value));
        return members;
    }
    Json write(const FloatValue& value, const FloatValue& standard, const Field&, const std::string& place) {
        if (!value.texture) return value.value;
        Json::Object members{{"texture", texture(*value.texture, place)}};
        if (!same(value.value, 1.0f)) members.emplace_back("factor", value.value);
        if (value.channel != standard.channel) {
            members.emplace_back("channel", std::string(1, "rgba"[static_cast<std::size_t>(value.channel)]));
        }
        return members;
    }

    std::string texture(const Image& image, const std::string& place) {
        if (image.source.empty()) problems_.push_back({"", place, "the texture came from no file and cannot be saved"});
        return relative(image.source);
    }

    std::string relative(const std::string& file) const {
        const fs::path path(file);
        if (!path.is_absolute()) return path.generic_string();
        const fs::path result = path.lexically_normal().lexically_relative(base_);
        return result.empty() ? path.generic_string() : result.generic_string();
    }

    Json::Object transform(const Transform& transform) {
        Json::Object members;
        if (transform.matrix) {
            Json::Array numbers;
            for (int i = 0; i < 16; ++i) numbers.emplace_back((*transform.matrix)[i / 4][i % 4]);
            members.emplace_back("matrix", std::move(numbers));
            return members;
        }
        const Transform standard;
        if (!same(transform.translate, standard.translate)) members.emplace_back("translate", vec(transform.translate));
        const Quat& q = transform.rotate;
        if (!same(q.w, 1) || !same(Vec3(q.x, q.y, q.z), Vec3(0)))
            members.emplace_back("rotate", Json::Array{q.x, q.y, q.z, q.w});
        const Vec3& s = transform.scale;
        if (!same(s, standard.scale)) members.emplace_back("scale", same(s, Vec3(s.x)) ? Json(s.x) : vec(s));
        return members;
    }

    Json::Array objects(ObjectId parent) {
        Json::Array list;
        const auto found = children_.find(parent.value);
        if (found == children_.end()) return list;
        for (const Object* object : found->second) list.emplace_back(this->object(*object));
        return list;
    }

    Json::Object object(const Object& object) {
        const std::string place = object.name;
        Json::Object members = variant(object.shape, place);
        if (!unnamed_.contains(&object)) members.emplace(members.begin() + 1, "name", object.name);
        if (object.material) members.emplace_back("material", *material_names_.at(object.material.value));
        Json::Object placed = transform(object.transform);
        if (!placed.empty()) members.emplace_back("transform", std::move(placed));
        if (!object.visible) members.emplace_back("visible", false);
        if (const auto* mesh = std::get_if<Mesh>(&object.shape); mesh && mesh->file.empty()) {
            problems_.push_back({"", place, "the mesh came from no file and cannot be saved"});
        }
        if (const auto* gltf = std::get_if<Gltf>(&object.shape)) gltf_materials(*gltf, members, place);
        if (Json::Array children = objects(object.id); !children.empty())
            members.emplace_back("objects", std::move(children));
        return members;
    }

    /// Writes which materials a glTF object uses where they are not its own by name, and remembers those that its file
    /// brings along.
    void gltf_materials(const Gltf& gltf, Json::Object& members, const std::string& place) {
        if (gltf.file.empty())
            problems_.push_back({"", place, "the glTF object came from no file and cannot be saved"});
        const auto file = cache_.gltf(gltf.file);
        if (!file || (*file)->materials.size() != gltf.materials.size()) return;  // Gone or changed: write them all.
        const std::string prefix = gltf_names_.prefix(gltf.file);
        Json::Array names;
        bool all_own = true;
        for (std::size_t i = 0; i < gltf.materials.size(); ++i) {
            const std::string own = prefix + (*file)->materials[i].name;
            if (!gltf.materials[i]) {
                names.emplace_back();
                all_own = false;
                continue;
            }
            const std::string& name = *material_names_.at(gltf.materials[i].value);
            names.emplace_back(name);
            if (name == own) {
                brought_.emplace(own, &(*file)->materials[i].material);
            } else {
                all_own = false;
            }
        }
        if (!all_own) members.emplace_back("materials", std::move(names));
        files_.push_back(*file);
    }

    /// Called after `objects`, which finds out what glTF files bring along.
    Json::Object materials() {
        Json::Object members;
        for (const MaterialEntry& entry : scene_.materials) {
            const std::string place = "materials." + entry.name;
            Json::Object written = variant(entry.material, place);
            const auto own = brought_.find(entry.name);
            if (own != brought_.end() && to_text(variant(*own->second, place)) == to_text(written)) continue;
            members.emplace_back(entry.name, std::move(written));
        }
        return members;
    }

    /// Names that the reader gives by itself, for the objects in the order in which they are written.
    void leave_out_names() {
        std::vector<const Object*> written;
        collect(ObjectId{}, written);
        std::vector<ObjectName> names;
        for (const Object* object : written) {
            names.push_back({std::visit([](const auto& shape) { return shape.kLabel; }, object->shape), object->name});
        }
        const std::vector<bool> left_out = names_to_leave_out(names);
        for (std::size_t i = 0; i < written.size(); ++i) {
            if (left_out[i]) unnamed_.insert(written[i]);
        }
    }

    void collect(ObjectId parent, std::vector<const Object*>& written) const {
        const auto found = children_.find(parent.value);
        if (found == children_.end()) return;
        for (const Object* object : found->second) {
            written.push_back(object);
            collect(object->id, written);
        }
    }

    const Scene& scene_;
    const fs::path& base_;
    AssetCache& cache_;
    GltfNames gltf_names_;
    Problems problems_;
    std::unordered_map<std::uint32_t, const std::string*> material_names_;
    std::unordered_map<std::uint32_t, std::vector<const Object*>> children_;
    std::unordered_set<const Object*> unnamed_;
    std::unordered_map<std::string, const Material*> brought_;  ///< Materials that the files in files_ bring along.
    std::vector<std::shared_ptr<const GltfFile>> files_;
};

}  // namespace

Result<std::string> scene_to_json(const Scene& scene, const fs::path& base, AssetCache* cache) {
    if (Problems problems = validate(scene); !problems.empty()) return tl::unexpected(std::move(problems));
    AssetCache own;
    std::error_code error;
    const fs::path folder = fs::absolute(base.empty() ? "." : base, error).lexically_normal();
    return SceneWriter(scene, folder, cache ? *cache : own).run();
}

Result<void> write_scene(const fs::path& path, const Scene& scene, AssetCache* cache) {
    Result<std::string> text = scene_to_json(scene, path.parent_path(), cache);
    if (text) return write_file(path, *text);
    for (Problem& problem : text.error()) problem.file = path.string();
    return tl::unexpected(std::move(text.error()));
}

}  // namespace rayuela
