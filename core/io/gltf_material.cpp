#include "core/io/gltf_internal.h"

#include "core/scene/validate.h"

#include <fmt/format.h>

namespace rayuela::gltf_internal {

namespace {

std::string percent_decoded(const std::string& uri) {
    const auto is_hex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && is_hex(uri[i + 1]) && is_hex(uri[i + 2])) {
            path += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            path += uri[i];
        }
    }
    return path;
}

/// Decodes the images that materials use, each once a decoding.
class TextureReader {
public:
    explicit TextureReader(Context& context) : context_(context) {}

    /// Null where there is no texture, or with a warning where it cannot be had.
    std::shared_ptr<const Image> read(int texture, ColorDecoding decoding, const std::string& place) {
        if (texture < 0) return nullptr;
        const auto& textures = context_.model.textures;
        if (static_cast<std::size_t>(texture) >= textures.size())
            return missing(place, fmt::format("textures[{}]", texture));
        const int image = textures[static_cast<std::size_t>(texture)].source;
        if (image < 0 || static_cast<std::size_t>(image) >= context_.model.images.size()) {
            return missing(place, fmt::format("the image of textures[{}]", texture));
        }
        auto [entry, is_new] = images_.try_emplace({image, decoding});
        if (is_new) entry->second = decode(image, decoding);
        return entry->second;
    }

private:
    std::shared_ptr<const Image> missing(const std::string& place, const std::string& what) {
        context_.warn(place, what + " does not exist");
        return nullptr;
    }

    std::shared_ptr<const Image> decode(int index, ColorDecoding decoding) {
        auto image = read_image(context_, index, decoding);
        if (image) return *image;
        context_.warn(fmt::format("images[{}]", index), image.error() + ": shown without this image");
        return nullptr;
    }

    Context& context_;
    std::map<std::pair<int, ColorDecoding>, std::shared_ptr<const Image>> images_;
};

using Extension = tinygltf::Value;

const Extension* find_extension(const tinygltf::Material& material, const std::string& name) {
    const auto found = material.extensions.find(name);
    return found != material.extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

float number(const Extension& extension, const std::string& key, float fallback) {
    if (!extension.Has(key) || !extension.Get(key).IsNumber()) return fallback;
    return static_cast<float>(extension.Get(key).GetNumberAsDouble());
}

int texture_index(const Extension& extension, const std::string& key) {
    if (!extension.Has(key)) return -1;
    const Extension& info = extension.Get(key);
    return info.Has("index") && info.Get("index").IsInt() ? info.Get("index").GetNumberAsInt() : -1;
}

Color color(const std::vector<double>& values, const Color& fallback) {
    return values.size() >= 3 ? Color(values[0], values[1], values[2]) : fallback;
}

/// Brings every number of the material into the range of its field.
void clamp_fields(Principled& material, Context& context, const std::string& place) {
    const auto clamp = [&](float& value, const Field& field) {
        const float clamped =
            std::isfinite(value) ? glm::clamp(value, field.min, field.max) : std::max(field.min, 0.0f);
        if (clamped == value) return;
        context.warn(place, fmt::format("{} must lie in [{}, {}], is {}: changed to {}", field.key, field.min,
                                        field.max, value, clamped));
        value = clamped;
    };
    Principled::visit_fields(material, [&](auto& member, const Field& field) {
        using Member = std::remove_cvref_t<decltype(member)>;
        if constexpr (std::is_same_v<Member, float>) {
            clamp(member, field);
        } else if constexpr (std::is_same_v<Member, FloatValue>) {
            clamp(member.value, field);
        } else {
            for (int channel = 0; channel < 3; ++channel) clamp(member.value[channel], field);
        }
    });
}

void read_extensions(const tinygltf::Material& from, Principled& to, TextureReader& textures, Context& context,
                     const std::string& place) {
    if (const Extension* e = find_extension(from, "KHR_materials_ior")) {
        to.ior = number(*e, "ior", 1.5f);
        if (to.ior == 0) {
            context.warn(place, "ior 0 (no Fresnel effect) is read as 1000");
            to.ior = 1000;
        }
    }
    if (const Extension* e = find_extension(from, "KHR_materials_transmission")) {
        to.transmission.value = number(*e, "transmissionFactor", 0);
        to.transmission.texture = textures.read(texture_index(*e, "transmissionTexture"), ColorDecoding::linear, place);
    }
    if (const Extension* e = find_extension(from, "KHR_materials_clearcoat")) {
        to.clearcoat = number(*e, "clearcoatFactor", 0);
        to.clearcoat_roughness = number(*e, "clearcoatRoughnessFactor", 0);
        if (e->Has("clearcoatTexture") || e->Has("clearcoatRoughnessTexture") || e->Has("clearcoatNormalTexture")) {
            context.warn(place, "textures of the clearcoat are ignored");
        }
    }
    if (const Extension* e = find_extension(from, "KHR_materials_emissive_strength")) {
        to.emissive_strength = number(*e, "emissiveStrength", 1);
    }
    if (from.extensions.contains("KHR_materials_unlit")) context.warn(place, "the unlit material is lit");
}

void tell_what_is_ignored(const tinygltf::Material& material, Context& context, const std::string& place) {
    if (!material.alphaMode.empty() && material.alphaMode != "OPAQUE") context.warn(place, "alpha is ignored");
    if (material.normalTexture.index >= 0) context.warn(place, "normal maps are ignored");
    const auto& pbr = material.pbrMetallicRoughness;
    for (const tinygltf::TextureInfo* info :
         {&pbr.baseColorTexture, &pbr.metallicRoughnessTexture, &material.emissiveTexture}) {
        if (info->extensions.contains("KHR_texture_transform")) context.warn(place, "texture transforms are ignored");
    }
}

Principled read_material(const tinygltf::Material& from, TextureReader& textures, Context& context,
                         const std::string& place) {
    const auto& pbr = from.pbrMetallicRoughness;
    Principled to;
    to.base_color = {color(pbr.baseColorFactor, Color(1)),
                     textures.read(pbr.baseColorTexture.index, ColorDecoding::srgb, place)};
    const auto metallic_roughness = textures.read(pbr.metallicRoughnessTexture.index, ColorDecoding::linear, place);
    to.metallic = {static_cast<float>(pbr.metallicFactor), metallic_roughness, 2};
    to.roughness = {static_cast<float>(pbr.roughnessFactor), metallic_roughness, 1};
    to.emissive = {color(from.emissiveFactor, Color(0)),
                   textures.read(from.emissiveTexture.index, ColorDecoding::srgb, place)};
    read_extensions(from, to, textures, context, place);
    tell_what_is_ignored(from, context, place);
    clamp_fields(to, context, place);
    return to;
}

}  // namespace

Expected<std::shared_ptr<const Image>> read_image(const Context& context, int index, ColorDecoding decoding) {
    if (index < 0 || static_cast<std::size_t>(index) >= context.model.images.size()) {
        return tl::unexpected<std::string>("does not exist");
    }
    const tinygltf::Image& image = context.model.images[static_cast<std::size_t>(index)];
    std::span<const unsigned char> bytes = image.image;
    if (image.bufferView >= 0) {
        const auto view = view_bytes(context.model, image.bufferView);
        if (!view) return tl::unexpected(view.error());
        bytes = *view;
    }
    if (bytes.empty()) {
        return tl::unexpected(image.uri.empty() ? std::string("is empty") : "'" + image.uri + "' is not there");
    }
    // tinygltf keeps a uri only of images that are files of their own.
    const bool is_file = image.bufferView < 0 && !image.uri.empty();
    const std::string source =
        is_file ? (context.path.parent_path() / percent_decoded(image.uri)).lexically_normal().string()
                : fmt::format("{}#{}", context.path.string(), index);
    auto image_read = open_image(std::as_bytes(bytes), source, decoding);
    if (!image_read) return tl::unexpected(image_read.error().front().cause);
    return *image_read;
}

std::vector<NamedMaterial> read_materials(Context& context) {
    TextureReader textures(context);
    std::vector<NamedMaterial> materials;
    std::set<std::string> names;
    for (std::size_t i = 0; i < context.model.materials.size(); ++i) {
        const tinygltf::Material& material = context.model.materials[i];
        const std::string place = fmt::format("materials[{}]", i);
        const std::string name = unique_name(material.name.empty() ? fmt::format("material {}", i) : material.name,
                                             [&](const std::string& candidate) { return names.contains(candidate); });
        names.insert(name);
        materials.push_back({name, read_material(material, textures, context, place)});
    }
    return materials;
}

int uv_set(Context& context, int material) {
    if (material < 0 || static_cast<std::size_t>(material) >= context.model.materials.size()) return 0;
    const tinygltf::Material& m = context.model.materials[static_cast<std::size_t>(material)];
    const auto& pbr = m.pbrMetallicRoughness;
    int set = -1;
    for (const tinygltf::TextureInfo* info :
         {&pbr.baseColorTexture, &pbr.metallicRoughnessTexture, &m.emissiveTexture}) {
        if (info->index < 0) continue;
        if (set < 0) set = std::max(info->texCoord, 0);
        if (set != info->texCoord) {
            context.warn(fmt::format("materials[{}]", material),
                         "its textures use several sets of coordinates: the first is used");
        }
    }
    return std::max(set, 0);
}

NamedMaterial default_material() {
    Principled material;
    material.metallic.value = 1;
    material.roughness.value = 1;
    return {"default", material};
}

}  // namespace rayuela::gltf_internal
