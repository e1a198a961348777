#include "core/io/gltf_reader.h"

#include "tests/unit/io/temp_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <bit>
#include <cstring>

namespace rayuela {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;
using GltfResult = Result<std::shared_ptr<const GltfFile>>;

template <typename T>
std::string raw(std::initializer_list<T> values) {
    std::string bytes;
    for (const T& value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return bytes;
}

std::string padded(std::string text, char with) {
    text.append((4 - text.size() % 4) % 4, with);
    return text;
}

/// A .glb of that JSON and binary chunk.
std::string glb(const std::string& json, const std::string& bin = {}) {
    const auto chunk = [](const std::string& data, std::uint32_t type) {
        return raw<std::uint32_t>({static_cast<std::uint32_t>(data.size()), type}) + data;
    };
    std::string body = chunk(padded(json, ' '), 0x4E4F534A);
    if (!bin.empty()) body += chunk(padded(bin, '\0'), 0x004E4942);
    return "glTF" + raw<std::uint32_t>({2, static_cast<std::uint32_t>(12 + body.size())}) + body;
}

GltfResult parse(const std::string& bytes, const std::filesystem::path& path = "/none/a.glb") {
    return parse_gltf(std::as_bytes(std::span(bytes)), path);
}

std::string error_of(const GltfResult& result) {
    return result ? "no error" : to_string(result.error());
}

std::string warnings_of(const GltfResult& result) {
    return result ? to_string((*result)->warnings) : "refused: " + error_of(result);
}

const std::string kPositions = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
const std::string kIndices = raw<std::uint16_t>({0, 1, 2, 2, 1, 3});
const std::string kBin = kPositions + kIndices;

/// A file of one node with one primitive over kBin; `extra` are more top-level members, `primitive` more of its own.
std::string square(const std::string& primitive = R"("indices": 1)", const std::string& extra = "",
                   const std::string& node = R"({"mesh": 0})",
                   const std::string& accessors =
                       R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"})") {
    return fmt::format(R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{}],
        "meshes": [{{"name": "square", "primitives": [{{"attributes": {{"POSITION": 0}}{}{}}}]}}],
        "buffers": [{{"byteLength": 60}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "accessors": [{}]{}{}}})",
                       node, primitive.empty() ? "" : ", ", primitive, accessors, extra.empty() ? "" : ", ", extra);
}

TEST(Gltf, IndexedTriangles) {
    const auto file = parse(glb(square(), kBin));
    ASSERT_TRUE(file) << error_of(file);
    ASSERT_EQ((*file)->geometry->parts.size(), 1u);
    const GltfPart& part = (*file)->geometry->parts[0];
    EXPECT_EQ(part.name, "square");
    EXPECT_EQ(part.mesh->triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_TRUE(part.to_file.is_identity());
    // Without a material: glTF's default.
    ASSERT_EQ((*file)->materials.size(), 1u);
    const auto& material = std::get<Principled>((*file)->materials[0].material);
    EXPECT_EQ(material.metallic.value, 1);
    EXPECT_EQ(material.roughness.value, 1);
    EXPECT_TRUE((*file)->warnings.empty()) << warnings_of(file);
}

TEST(Gltf, StripsAndFansFaceTheSameWay) {
    // The square's corners 0 1 2 3 are a strip; 0 1 3 2 would be a fan.
    for (const auto& [mode, indexed] : {std::pair{5, false}, {6, true}}) {
        const std::string bin = kPositions + raw<std::uint16_t>({0, 1, 3, 2, 0, 0});
        std::string primitive = fmt::format(R"("mode": {})", mode);
        if (indexed) primitive += R"(, "indices": 1)";
        const auto file = parse(glb(square(primitive, "", R"({"mesh": 0})",
                                           R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                                              {"bufferView": 1, "componentType": 5123, "count": 4, "type": "SCALAR"})"),
                                    bin));
        ASSERT_TRUE(file) << error_of(file);
        const TriangleMesh& mesh = *(*file)->geometry->parts[0].mesh;
        EXPECT_EQ(mesh.triangles.size(), 2u);
        for (const glm::uvec3& t : mesh.triangles) {
            const Vec3 normal =
                glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
            EXPECT_EQ(normal, Vec3(0, 0, 1)) << "mode " << mode;
        }
    }
}

TEST(Gltf, PointsAndLinesAreLeftOut) {
    for (const int mode : {0, 1, 2, 3}) {
        const auto file = parse(glb(square(fmt::format(R"("mode": {})", mode)), kBin));
        ASSERT_TRUE(file);
        EXPECT_TRUE((*file)->geometry->parts.empty());
        EXPECT_THAT(warnings_of(file), HasSubstr("points and lines are left out"));
    }
}

TEST(Gltf, QuantizedAndSparsePositions) {
    // Signed bytes, normalized, 4 bytes apart; the last element is replaced by a sparse one.
    const std::string bin = raw<std::int8_t>({-128, 0, 127, 0, 127, 0, 0, 0, 0, 127, 0, 0}) +
                            raw<std::uint8_t>({2, 0, 0, 0}) + raw<std::int8_t>({0, -127, 64, 0});
    const std::string json = R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_mesh_quantization"],
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": 20}],
        "bufferViews": [{"buffer": 0, "byteLength": 12, "byteStride": 4}, {"buffer": 0, "byteOffset": 12, "byteLength": 1},
                        {"buffer": 0, "byteOffset": 16, "byteLength": 3}],
        "accessors": [{"bufferView": 0, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3",
            "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2}}}]})";
    const auto file = parse(glb(json, bin));
    ASSERT_TRUE(file) << error_of(file);
    const std::vector<Vec3> expected = {{-1, 0, 1}, {1, 0, 0}, {0, -1, 64.0f / 127}};
    EXPECT_EQ((*file)->geometry->parts[0].mesh->positions, expected);
}

TEST(Gltf, NodeTransformsMultiply) {
    const std::string nodes = R"({"translation": [1, 2, 3], "children": [1]},
        {"rotation": [0, 0, 0.70710678, 0.70710678], "scale": [2, 2, 2], "children": [2, 3]},
        {"mesh": 0}, {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1], "mesh": 0})";
    const auto file = parse(glb(square(R"("indices": 1)", "", nodes), kBin));
    ASSERT_TRUE(file) << error_of(file);
    ASSERT_EQ((*file)->geometry->parts.size(), 2u);
    const auto& [first, second] = std::tie((*file)->geometry->parts[0], (*file)->geometry->parts[1]);
    EXPECT_EQ(first.mesh, second.mesh) << "instances share their mesh";
    // x is turned to y, doubled and moved.
    EXPECT_NEAR(glm::length(first.to_file.point({1, 0, 0}) - Vec3(1, 4, 3)), 0, 1e-6);
    EXPECT_NEAR(glm::length(second.to_file.point({0, 0, 0}) - Vec3(1, 22, 3)), 0, 1e-5);
}

TEST(Gltf, CyclesDeepChainsAndLostNodes) {
    const auto cycle =
        parse(glb(square(R"("indices": 1)", "", R"({"mesh": 0, "children": [1, 7]}, {"children": [0]})"), kBin));
    ASSERT_TRUE(cycle) << error_of(cycle);
    EXPECT_EQ((*cycle)->geometry->parts.size(), 1u);
    EXPECT_THAT(warnings_of(cycle), HasSubstr("nodes[0]: has two parents or is its own ancestor"));
    EXPECT_THAT(warnings_of(cycle), HasSubstr("nodes[7]: does not exist"));

    std::string chain;
    constexpr int kDepth = 100000;
    for (int i = 0; i < kDepth; ++i) chain += fmt::format(R"({{"translation": [1, 0, 0], "children": [{}]}},)", i + 1);
    const auto deep = parse(glb(square(R"("indices": 1)", "", chain + R"({"mesh": 0})"), kBin));
    ASSERT_TRUE(deep) << error_of(deep);
    EXPECT_EQ((*deep)->geometry->parts[0].to_file.translation, Vec3(kDepth, 0, 0));
}

TEST(Gltf, SingularNodesAreLeftOutMirrorsStay) {
    const auto flat = parse(glb(square(R"("indices": 1)", "", R"({"mesh": 0, "scale": [1, 0, 1]})"), kBin));
    ASSERT_TRUE(flat);
    EXPECT_TRUE((*flat)->geometry->parts.empty());
    EXPECT_THAT(warnings_of(flat), HasSubstr("nodes[0]: its transform has no inverse"));
    const auto mirror = parse(glb(square(R"("indices": 1)", "", R"({"mesh": 0, "scale": [-1, 1, 1]})"), kBin));
    ASSERT_TRUE(mirror);
    EXPECT_EQ((*mirror)->geometry->parts.size(), 1u);
}

TEST(Gltf, Cameras) {
    const auto file = parse(glb(
        square(
            R"("indices": 1)",
            R"("cameras": [{"type": "perspective", "perspective": {"yfov": 0.78539816, "znear": 0.1}},
            {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 1}}])",
            R"({"mesh": 0, "children": [1, 2]}, {"name": "eye", "camera": 0, "translation": [0, 0, 9]}, {"camera": 1})"),
        kBin));
    ASSERT_TRUE(file) << error_of(file);
    ASSERT_EQ((*file)->cameras.size(), 1u);
    EXPECT_EQ((*file)->cameras[0].name, "eye");
    EXPECT_NEAR((*file)->cameras[0].vfov, 45, 1e-4);
    EXPECT_EQ((*file)->cameras[0].to_file.translation, Vec3(0, 0, 9));
    EXPECT_THAT(warnings_of(file), HasSubstr("not perspective"));
}

TEST(Gltf, MaterialsAndTheirExtensions) {
    const auto file = parse(glb(
        square(R"("indices": 1, "material": 1)", R"("extensionsUsed": ["KHR_materials_ior", "EXT_other"], "materials": [
            {"name": "twice"},
            {"name": "twice", "emissiveFactor": [0, 0.5, 1], "alphaMode": "BLEND",
             "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 7, 1], "metallicFactor": 0.25, "roughnessFactor": 0.75},
             "extensions": {"KHR_materials_ior": {"ior": 1.33}, "KHR_materials_transmission": {"transmissionFactor": 0.5},
                            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.125},
                            "KHR_materials_emissive_strength": {"emissiveStrength": 5}}}])"),
        kBin));
    ASSERT_TRUE(file) << error_of(file);
    ASSERT_EQ((*file)->materials.size(), 2u);
    EXPECT_EQ((*file)->materials[0].name, "twice");
    EXPECT_EQ((*file)->materials[1].name, "twice 2");
    EXPECT_EQ((*file)->geometry->parts[0].material, 1u);
    const auto& m = std::get<Principled>((*file)->materials[1].material);
    EXPECT_EQ(m.base_color.value, Color(0.1f, 0.2f, 1));
    EXPECT_EQ(m.metallic.value, 0.25f);
    EXPECT_EQ(m.roughness.value, 0.75f);
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_EQ(m.transmission.value, 0.5f);
    EXPECT_EQ(m.clearcoat, 1);
    EXPECT_EQ(m.clearcoat_roughness, 0.125f);
    EXPECT_EQ(m.emissive.value, Color(0, 0.5f, 1));
    EXPECT_EQ(m.emissive_strength, 5);
    EXPECT_THAT(warnings_of(file), HasSubstr("materials[1]: base_color must lie in [0, 1], is 7: changed to 1"));
    EXPECT_THAT(warnings_of(file), HasSubstr("alpha is ignored"));
    EXPECT_THAT(warnings_of(file), HasSubstr("EXT_other is ignored"));
}

Image checker() {
    return {2, 1, {Vec4(1, 0, 0, 1), Vec4(0, 0.25f, 1, 1)}, {}};
}

TEST(Gltf, TexturesBesideTheFileAndWithinIt) {
    const TempFolder folder;
    ASSERT_TRUE(write_image(folder.path / "my image.png", checker()));
    const std::string png = testing::slurp(folder.path / "my image.png");
    const std::string json =
        fmt::format(R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
        "buffers": [{{"byteLength": {}}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 32}},
                        {{"buffer": 0, "byteOffset": 80, "byteLength": {}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                      {{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"}}],
        "images": [{{"uri": "my%20image.png"}}, {{"bufferView": 2, "mimeType": "image/png"}}],
        "textures": [{{"source": 0}}, {{"source": 1}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "metallicRoughnessTexture": {{"index": 1}}}}}}]
        }})",
                    80 + png.size(), png.size());
    const auto path = folder.write("a.glb", glb(json, kPositions + raw<float>({0, 0, 1, 0, 0, 1, 1, 1}) + png));
    const auto file = read_gltf(path);
    ASSERT_TRUE(file) << error_of(file);
    EXPECT_TRUE((*file)->warnings.empty()) << warnings_of(file);
    const auto& m = std::get<Principled>((*file)->materials[0].material);
    ASSERT_TRUE(m.base_color.texture && m.metallic.texture);
    EXPECT_EQ(m.base_color.texture->source, (folder.path / "my image.png").string());
    EXPECT_EQ(m.metallic.texture->source, path.string() + "#1");
    EXPECT_EQ(m.metallic.texture, m.roughness.texture);
    EXPECT_EQ(m.metallic.channel, 2);
    EXPECT_EQ(m.roughness.channel, 1);
    // 0.25 is encoded as 137/255: decoded where it is a colour, as it is where it is data.
    EXPECT_NEAR(with_pixels(m.base_color.texture)->at(1, 0).y, 0.25f, 0.005f);
    EXPECT_NEAR(with_pixels(m.metallic.texture)->at(1, 0).y, 137.0f / 255, 1e-6f);
    EXPECT_TRUE(m.base_color.texture->pixels.empty()) << "decoded for whom it is shown";
    // The first row of texels is at v = 1.
    EXPECT_EQ((*file)->geometry->parts[0].mesh->uvs[0], Vec2(0, 1));

    const auto image = read_gltf_image(path, 1, ColorDecoding::linear);
    ASSERT_TRUE(image);
    EXPECT_EQ(with_pixels(*image)->pixels, with_pixels(m.metallic.texture)->pixels);
    EXPECT_FALSE(read_gltf_image(path, 2, ColorDecoding::linear));
}

TEST(Gltf, PathsThatLeaveTheFolderAreRefusedByName) {
    const TempFolder folder;
    folder.write("secret.bin", kBin);
    const std::string image = R"("images": [{"uri": "../secret.png"}], "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])";
    std::filesystem::create_directory(folder.path / "in");
    ASSERT_TRUE(write_image(folder.path / "secret.png", checker()));
    const auto with_image = read_gltf(folder.write("in/a.glb", glb(square(R"("indices": 1)", image), kBin)));
    ASSERT_TRUE(with_image) << error_of(with_image);
    EXPECT_EQ(std::get<Principled>((*with_image)->materials[0].material).base_color.texture, nullptr);
    EXPECT_THAT(warnings_of(with_image), HasSubstr("secret.png: lies outside the folder"));

    std::string json = square();
    json.replace(json.find(R"({"byteLength": 60})"), 18, R"({"byteLength": 60, "uri": "%2e%2e/secret.bin"})");
    const auto with_buffer = read_gltf(folder.write("in/b.gltf", json));
    ASSERT_FALSE(with_buffer);
    EXPECT_THAT(error_of(with_buffer), HasSubstr("secret.bin: lies outside the folder"));
    // Its neighbour may be read.
    folder.write("in/data.bin", kBin);
    json.replace(json.find("%2e%2e/secret.bin"), 17, "data.bin");
    EXPECT_TRUE(read_gltf(folder.write("in/c.gltf", json)));
}

TEST(Gltf, BrokenFilesAreRefusedWithTheCause) {
    const auto with_accessor = [](const std::string& position, const std::string& indices = R"({"bufferView": 1,
        "componentType": 5123, "count": 6, "type": "SCALAR"})") {
        return glb(square(R"("indices": 1)", "", R"({"mesh": 0})", position + ", " + indices), kBin);
    };
    const std::string good = R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})";
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"", "is empty"},
        {"{nope", "line 1"},
        {glb("{}"), "asset"},
        {glb(R"({"asset": {"version": "1.0"}})"), "asset.version: must be 2.x, is '1.0'"},
        {glb(R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]})"),
         "KHR_draco_mesh_compression is required and not supported"},
        {glb(R"({"asset": {"version": "2.0"}, "extras": )" + std::string(100000, '[') + std::string(100000, ']') + "}"),
         "nested too deeply"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"})"),
         "accessors[0]: 5 elements"},
        {with_accessor(
             R"({"bufferView": 0, "byteOffset": 18446744073709551612, "componentType": 5126, "count": 4, "type": "VEC3"})"),
         "do not fit bufferViews[0] of 48 bytes"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1537228672809129302, "type": "VEC3"})"),
         "do not fit"},
        {with_accessor(R"({"componentType": 5126, "count": 4000000000, "type": "VEC3"})"), "has too many elements"},
        {with_accessor(R"({"bufferView": 9, "componentType": 5126, "count": 4, "type": "VEC3"})"),
         "bufferViews[9] does not exist"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"})"),
         "has the wrong type"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5130, "count": 2, "type": "VEC3"})"),
         "unknown component type"},
        {with_accessor(good, R"({"bufferView": 1, "componentType": 5122, "count": 6, "type": "SCALAR"})"),
         "indices must be unsigned integers"},
        {with_accessor(good, R"({"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"})"), "no error"},
        {with_accessor(good, R"({"bufferView": 0, "componentType": 5123, "count": 24, "type": "SCALAR"})"),
         "index 16256 is out of range, there are 4"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 1,
            "indices": {"bufferView": 1, "byteOffset": 10, "componentType": 5123}, "values": {"bufferView": 0, "byteOffset": 40}}})"),
         "do not fit"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3", "sparse": {"count": 1,
            "indices": {"bufferView": 1, "byteOffset": 10, "componentType": 5123}, "values": {"bufferView": 0}}})"),
         "sparse index 3 is out of range"},
        {with_accessor(R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": -1,
            "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}})"),
         "damaged sparse part"},
    };
    for (const auto& [bytes, message] : cases) EXPECT_THAT(error_of(parse(bytes)), HasSubstr(message));
}

TEST(Gltf, NanPositionsAreRefused) {
    const std::string bin = raw<float>({0, 0, NAN, 1, 0, 0, 0, 1, 0, 1, 1, 0}) + kIndices;
    EXPECT_THAT(error_of(parse(glb(square(), bin))), HasSubstr("meshes[0].primitives[0]: vertex 0 is not finite"));
}

TEST(Gltf, EveryTruncationAndManyMutationsAreSurvived) {
    const std::string bytes = glb(square(), kBin);
    for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(parse(bytes.substr(0, size))) << size;
    std::uint32_t state = 1;
    const auto next = [&](std::size_t n) { return (state = state * 1664525u + 1013904223u) / 65536u % n; };
    for (int i = 0; i < 3000; ++i) {
        std::string mutated = bytes;
        for (int k = 0; k < 3; ++k) mutated[next(mutated.size())] = static_cast<char>(next(256));
        const auto file = parse(mutated);
        if (!file) continue;
        for (const GltfPart& part : (*file)->geometry->parts) {
            ASSERT_LT(part.material, (*file)->materials.size());
            for (const glm::uvec3& t : part.mesh->triangles)
                ASSERT_LT(std::max({t.x, t.y, t.z}), part.mesh->positions.size());
        }
    }
}

}  // namespace
}  // namespace rayuela
