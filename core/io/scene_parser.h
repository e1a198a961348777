#pragma once

#include "core/io/gltf_names.h"
#include "core/io/json_reader.h"
#include "core/io/scene_reader.h"

#include <optional>
#include <unordered_map>

namespace rayuela {

inline constexpr int kSceneFormatVersion = 1;

/// Makes a scene of a scene file's JSON, once. Each function reads one part of the format; what is wrong is collected.
class SceneParser {
public:
    SceneParser(std::filesystem::path base, std::string name, AssetCache& cache)
        : base_(std::move(base)), problems_(std::move(name)), cache_(cache) {}

    Result<LoadedScene> run(const Json& json);

private:
    void film(const Json& json);
    void camera(const Json& json);
    void environment(const Json& json);
    void materials(const Json& json);
    void objects(const Json& json, const std::string& place, ObjectId parent);
    void object(const Json& json, const std::string& place, ObjectId parent);
    void render(const Json& json);

    /// Notes that an object (a slot of its glTF materials) uses a material, which may be met later.
    void use_material(const Json& json, const std::string& place, std::optional<std::size_t> slot = std::nullopt);
    void resolve_materials();
    MaterialId add_material(const std::string& name, const Material& material);
    void gltf_materials(Gltf& gltf, const GltfFile& file, const Json* names, const std::string& place);
    void name_objects();

    /// Makes `variant` the alternative that "type" names; false, and told, where there is none.
    template <typename Variant>
    bool choose_type(JsonObject& object, Variant& variant);
    template <typename T>
    void fields(JsonObject& object, T& value);
    template <typename T>
    void setting(JsonObject& object, T& value, const SettingField& field);

    void member(const Json& json, const std::string& place, const Field& field, float& value);
    void member(const Json& json, const std::string& place, const Field& field, bool& value);
    void member(const Json& json, const std::string& place, const Field& field, std::string& value);
    void member(const Json& json, const std::string& place, const Field& field, Vec3& value);
    void member(const Json& json, const std::string& place, const Field& field, std::array<Vec3, 3>& value);
    void member(const Json& json, const std::string& place, const Field& field, ColorValue& value);
    void member(const Json& json, const std::string& place, const Field& field, FloatValue& value);
    std::shared_ptr<const Image> texture(JsonObject& object, ColorDecoding decoding);

    /// Fills in what a file field names.
    template <typename T>
    void load(T&, JsonObject&) {}
    void load(Mesh& mesh, JsonObject& object);
    void load(Gltf& gltf, JsonObject& object);
    void load(ImageEnvironment& environment, JsonObject& object);
    /// Tells each problem of a file at the place that named it.
    void tell(const Problems& problems, const std::string& place);
    std::string absolute(const std::string& file) const;

    std::filesystem::path base_;
    ProblemList problems_;
    AssetCache& cache_;
    Scene scene_;
    Problems warnings_;
    GltfNames gltf_names_;
    struct MaterialUse {
        std::size_t object;
        std::optional<std::size_t> slot;
        std::string name, place;
    };
    std::vector<MaterialUse> material_uses_;
    std::unordered_map<std::string, MaterialId> material_ids_;
};

}  // namespace rayuela
