#include "core/io/gltf_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/gltf_internal.h"
#include "core/io/json.h"
#include "core/scene/camera.h"
#include "core/scene/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace rayuela {

namespace fs = std::filesystem;
using namespace gltf_internal;

namespace {

/// Extensions whose absence would not make the file something else than what this reader gives.
constexpr std::array<std::string_view, 7> kKnownExtensions{
    "KHR_mesh_quantization",           "KHR_materials_ior",   "KHR_materials_transmission", "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_lights_punctual"};
constexpr std::string_view kLights = "KHR_lights_punctual";

/// What tinygltf's callbacks know: the only folder it may read from.
struct Folder {
    fs::path path;
    Problems refused;
};

bool is_inside(const fs::path& file, const fs::path& folder) {
    const fs::path relative = file.lexically_normal().lexically_relative(folder.lexically_normal());
    return !relative.empty() && *relative.begin() != "..";
}

bool file_exists(const std::string& file, void* user) {
    auto& folder = *static_cast<Folder*>(user);
    if (!is_inside(file, folder.path)) {
        // tinygltf looks beside the working directory too; only what was meant for our folder is worth telling.
        if (fs::path(file).is_absolute()) {
            folder.refused.push_back({"", file, "lies outside the folder of the file and is refused"});
        }
        return false;
    }
    std::error_code error;
    return fs::is_regular_file(file, error);
}

std::string same_path(const std::string& file, void*) {
    return file;
}

bool read_whole_file(std::vector<unsigned char>* bytes, std::string* error, const std::string& file, void*) {
    const Result<std::string> content = read_file(file);
    if (!content) {
        *error += to_string(content.error());
        return false;
    }
    bytes->assign(content->begin(), content->end());
    return true;
}

/// All that this release of tinygltf has: newer ones have more, and take none unless all are there.
template <typename Callbacks = tinygltf::FsCallbacks>
Callbacks callbacks_into(Folder& folder) {
    Callbacks callbacks{};
    callbacks.FileExists = file_exists;
    callbacks.ExpandFilePath = same_path;
    callbacks.ReadWholeFile = read_whole_file;
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
        return false;
    };
    if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
        callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string* error, const std::string& file, void*) {
            std::error_code code;
            *size = fs::file_size(file, code);
            if (code) *error += code.message();
            return !code;
        };
    }
    callbacks.user_data = &folder;
    return callbacks;
}

/// Keeps an image encoded: only those that materials use are decoded, later. What lies in a buffer stays there.
bool keep_image(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                void*) {
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    image->as_is = true;
    return true;
}

std::string first_line(std::string text) {
    const std::size_t end = text.find_last_not_of(" \n");
    text.resize(end == std::string::npos ? 0 : end + 1);
    std::ranges::replace(text, '\n', ' ');
    return text.substr(0, 500);
}

/// The JSON part of a .glb, as far as its header can be believed; all of a .gltf.
std::string_view json_part(std::string_view bytes) {
    if (!bytes.starts_with("glTF") || bytes.size() < 20) return bytes;
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return bytes.substr(20, length);
}

bool is_supported(std::string_view extension) {
    return extension != kLights && std::ranges::find(kKnownExtensions, extension) != kKnownExtensions.end();
}

std::vector<std::string> unknown_required_extensions(std::string_view text, const std::string& name) {
    std::vector<std::string> unknown;
    const Result<Json> json = parse_json(text, name);
    const Json* required = json ? json->find("extensionsRequired") : nullptr;
    const auto* list = required ? required->get<Json::Array>() : nullptr;
    for (std::size_t i = 0; list && i < list->size(); ++i) {
        const auto* extension = (*list)[i].get<std::string>();
        if (extension && !is_supported(*extension)) unknown.push_back(*extension);
    }
    return unknown;
}

Result<tinygltf::Model> parse(std::string_view bytes, const fs::path& path, Problems& warnings) {
    const std::string name = path.string();
    if (bytes.empty()) return fail(name, "", "is empty");
    if (bytes.size() > std::numeric_limits<unsigned>::max()) return fail(name, "", "is larger than 4 GiB");
    // tinygltf follows nested values by recursion.
    if (json_depth(json_part(bytes)) > kMaxJsonDepth) return fail(name, "", "its JSON is nested too deeply");

    tinygltf::TinyGLTF loader;
    Folder folder{path.parent_path(), {}};
    loader.SetFsCallbacks(callbacks_into(folder));
    loader.SetImageLoader(keep_image, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    bool ok = false;
    const auto size = static_cast<unsigned>(bytes.size());
    try {
        ok = bytes.starts_with("glTF")
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                               reinterpret_cast<const unsigned char*>(bytes.data()), size,
                                               folder.path.string())
                 : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, folder.path.string());
    } catch (const std::exception& exception) {
        error += exception.what();
    }
    for (Problem& problem : folder.refused) problem.file = name;
    if (!ok) {
        Problems problems = std::move(folder.refused);
        // Without what it requires a file may well look broken: that is the cause to tell.
        for (const std::string& extension : unknown_required_extensions(json_part(bytes), name)) {
            problems.push_back({name, "extensionsRequired", extension + " is required and not supported"});
        }
        if (problems.empty())
            problems.push_back({name, "", error.empty() ? "is no valid glTF file" : first_line(error)});
        return tl::unexpected(std::move(problems));
    }
    warnings = std::move(folder.refused);
    if (!warning.empty()) warnings.push_back({name, "", first_line(warning)});
    if (!error.empty()) warnings.push_back({name, "", first_line(error)});
    return model;
}

Problems check_extensions(const tinygltf::Model& model, Context& context) {
    Problems problems;
    if (!model.asset.version.starts_with("2.")) {
        problems.push_back({context.path.string(), "asset.version", "must be 2.x, is '" + model.asset.version + "'"});
    }
    for (const std::string& name : model.extensionsRequired) {
        if (is_supported(name)) continue;
        problems.push_back({context.path.string(), "extensionsRequired", name + " is required and not supported"});
    }
    for (const std::string& name : model.extensionsUsed) {
        const bool known =
            std::ranges::find(kKnownExtensions, name) != kKnownExtensions.end() || name == "KHR_texture_transform";
        if (!known) context.warn("extensionsUsed", name + " is ignored");
        if (name == kLights) context.warn("extensionsUsed", "point, spot and directional lights are ignored");
    }
    return problems;
}

/// Walks the nodes of the default scene and collects parts and cameras.
class NodeReader {
public:
    NodeReader(Context& context, GltfFile& file) : context_(context), file_(file), primitives_(context) {}

    std::optional<std::string> run() {
        const tinygltf::Model& model = context_.model;
        visited_.resize(model.nodes.size());
        for (const int root : roots()) stack_.push_back({root, glm::dmat4(1)});
        std::ranges::reverse(stack_);
        while (!stack_.empty()) {
            const Entry entry = stack_.back();
            stack_.pop_back();
            if (auto cause = visit(entry)) return cause;
        }
        return std::nullopt;
    }

    GltfGeometry geometry;

private:
    struct Entry {
        int node;
        glm::dmat4 parent;
    };

    std::vector<int> roots() {
        const tinygltf::Model& model = context_.model;
        if (!model.scenes.empty()) {
            const bool known =
                model.defaultScene >= 0 && static_cast<std::size_t>(model.defaultScene) < model.scenes.size();
            if (!known && model.defaultScene != -1) context_.warn("scene", "does not exist: the first is shown");
            return model.scenes[known ? static_cast<std::size_t>(model.defaultScene) : 0].nodes;
        }
        std::vector<bool> is_child(model.nodes.size());
        for (const tinygltf::Node& node : model.nodes) {
            for (const int child : node.children) {
                if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
                    is_child[static_cast<std::size_t>(child)] = true;
            }
        }
        std::vector<int> result;
        for (std::size_t i = 0; i < is_child.size(); ++i) {
            if (!is_child[i]) result.push_back(static_cast<int>(i));
        }
        return result;
    }

    std::optional<std::string> visit(const Entry& entry) {
        const std::string place = fmt::format("nodes[{}]", entry.node);
        if (entry.node < 0 || static_cast<std::size_t>(entry.node) >= context_.model.nodes.size()) {
            context_.warn(place, "does not exist");
            return std::nullopt;
        }
        const auto index = static_cast<std::size_t>(entry.node);
        if (visited_[index]) {
            context_.warn(place, "has two parents or is its own ancestor: shown once");
            return std::nullopt;
        }
        visited_[index] = true;
        const tinygltf::Node& node = context_.model.nodes[index];
        const glm::dmat4 to_file = entry.parent * local_matrix(node, place);
        // In reverse, so that the stack gives them in the file's order.
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
            stack_.push_back({*child, to_file});
        const Affine affine{Mat3(to_file), Vec3(to_file[3])};
        if (node.camera >= 0) add_camera(node, affine, place);
        return node.mesh >= 0 ? add_mesh(node, affine, place) : std::nullopt;
    }

    glm::dmat4 local_matrix(const tinygltf::Node& node, const std::string& place) {
        const auto usable = [&](const std::vector<double>& values, std::size_t size, const char* what) {
            if (values.empty()) return false;
            if (values.size() == size && std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
                return true;
            context_.warn(place, fmt::format("its {} must be {} finite numbers: ignored", what, size));
            return false;
        };
        glm::dmat4 m(1);
        if (usable(node.matrix, 16, "matrix")) {
            for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
            return m;
        }
        glm::dquat q(1, 0, 0, 0);
        if (usable(node.rotation, 4, "rotation")) {
            q = {node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]};
            const double length = glm::length(q);
            if (!(length > 0)) context_.warn(place, "its rotation is zero: ignored");
            q = length > 0 ? q / length : glm::dquat(1, 0, 0, 0);
        }
        m = glm::mat4_cast(q);
        if (usable(node.scale, 3, "scale")) {
            for (int axis = 0; axis < 3; ++axis) m[axis] *= node.scale[static_cast<std::size_t>(axis)];
        }
        if (usable(node.translation, 3, "translation")) {
            m[3] = {node.translation[0], node.translation[1], node.translation[2], 1};
        }
        return m;
    }

    void add_camera(const tinygltf::Node& node, const Affine& to_file, const std::string& place) {
        if (static_cast<std::size_t>(node.camera) >= context_.model.cameras.size()) {
            return context_.warn(place, fmt::format("cameras[{}] does not exist", node.camera));
        }
        const tinygltf::Camera& camera = context_.model.cameras[static_cast<std::size_t>(node.camera)];
        if (camera.type != "perspective") return context_.warn(place, "its camera is not perspective and is ignored");
        const double vfov = glm::degrees(camera.perspective.yfov);
        if (!(vfov > 0 && vfov < 179) || !to_file.is_invertible()) {
            return context_.warn(place,
                                 fmt::format("its camera has an opening of {} degrees or no size: ignored", vfov));
        }
        file_.cameras.push_back({camera.name.empty() ? node.name : camera.name, to_file, static_cast<float>(vfov)});
    }

    std::optional<std::string> add_mesh(const tinygltf::Node& node, const Affine& to_file, const std::string& place) {
        if (static_cast<std::size_t>(node.mesh) >= context_.model.meshes.size()) {
            context_.warn(place, fmt::format("meshes[{}] does not exist", node.mesh));
            return std::nullopt;
        }
        if (!to_file.is_invertible()) {
            context_.warn(place, "its transform has no inverse (a scale of 0?): left out");
            return std::nullopt;
        }
        if (node.skin >= 0) context_.warn(place, "skins are ignored: the rest pose is shown");
        const tinygltf::Mesh& mesh = context_.model.meshes[static_cast<std::size_t>(node.mesh)];
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const std::string where = fmt::format("meshes[{}].primitives[{}]", node.mesh, i);
            const tinygltf::Primitive& primitive = mesh.primitives[i];
            auto read = primitives_.read(primitive, uv_set(context_, primitive.material), where);
            if (!read) return where + ": " + read.error();
            if (!*read) continue;
            std::string name = node.name.empty() ? mesh.name : node.name;
            if (mesh.primitives.size() > 1) name += fmt::format(" {}", i + 1);
            geometry.parts.push_back({std::move(name), *read, to_file, material_of(primitive, where)});
        }
        return std::nullopt;
    }

    std::uint32_t material_of(const tinygltf::Primitive& primitive, const std::string& place) {
        const std::size_t count = context_.model.materials.size();
        if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) < count) {
            return static_cast<std::uint32_t>(primitive.material);
        }
        if (primitive.material >= 0)
            context_.warn(place, fmt::format("materials[{}] does not exist", primitive.material));
        if (file_.materials.size() == count) {
            NamedMaterial material = default_material();
            material.name = unique_name(material.name, [&](const std::string& name) {
                return std::ranges::find(file_.materials, name, &NamedMaterial::name) != file_.materials.end();
            });
            file_.materials.push_back(std::move(material));
        }
        return static_cast<std::uint32_t>(count);
    }

    Context& context_;
    GltfFile& file_;
    PrimitiveReader primitives_;
    std::vector<bool> visited_;
    std::vector<Entry> stack_;
};

Result<std::shared_ptr<const GltfFile>> build(const tinygltf::Model& model, const fs::path& path, Problems warnings) {
    Context context{model, path, std::move(warnings), {}};
    if (Problems problems = check_extensions(model, context); !problems.empty())
        return tl::unexpected(std::move(problems));
    auto file = std::make_shared<GltfFile>();
    file->materials = read_materials(context);
    NodeReader nodes(context, *file);
    if (auto cause = nodes.run()) return fail(path.string(), "", *cause);
    if (nodes.geometry.parts.empty()) context.warn("", "shows no triangles");
    file->geometry = std::make_shared<const GltfGeometry>(std::move(nodes.geometry));
    file->warnings = std::move(context.warnings);
    return file;
}

Result<std::shared_ptr<const GltfFile>> read(std::string_view bytes, const fs::path& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error).lexically_normal();
    Problems warnings;
    Result<tinygltf::Model> model = parse(bytes, absolute, warnings);
    if (!model) return tl::unexpected(std::move(model.error()));
    return build(*model, absolute, std::move(warnings));
}

}  // namespace

Result<std::shared_ptr<const GltfFile>> parse_gltf(std::span<const std::byte> bytes, const fs::path& path) {
    return read({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

Result<std::shared_ptr<const GltfFile>> read_gltf(const fs::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return read(*bytes, path);
}

Result<std::shared_ptr<const Image>> read_gltf_image(const fs::path& path, int index, ColorDecoding decoding) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    Problems warnings;
    const Result<tinygltf::Model> model = parse(*bytes, path, warnings);
    if (!model) return tl::unexpected(model.error());
    auto image = gltf_internal::read_image({*model, path, {}, {}}, index, decoding);
    if (!image) return fail(path.string(), fmt::format("images[{}]", index), image.error());
    return *image;
}

bool is_gltf_file(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".gltf" || extension == ".glb";
}

}  // namespace rayuela
