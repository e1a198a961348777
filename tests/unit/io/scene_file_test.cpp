#include "core/io/image_io.h"
#include "core/io/json.h"
#include "core/io/mesh_io.h"
#include "core/io/scene_reader.h"
#include "core/io/scene_writer.h"
#include "core/math/srgb.h"
#include "core/scene/scene_edit.h"
#include "tests/support/random_scene.h"
#include "tests/unit/io/temp_folder.h"

#include <gmock/gmock.h>

#include <cstring>

namespace rayuela {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::TempFolder;

Scene scene_of(const std::string& text, const std::filesystem::path& base = ".") {
    auto loaded = scene_from_json(text, base, "a.scene.json");
    EXPECT_TRUE(loaded) << (loaded ? "" : to_string(loaded.error()));
    return loaded ? loaded->scene : Scene{};
}

std::string text_of(const Scene& scene, const std::filesystem::path& base = ".") {
    auto text = scene_to_json(scene, base);
    EXPECT_TRUE(text) << (text ? "" : to_string(text.error()));
    return text.value_or("");
}

TriangleMesh tetrahedron() {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

/// A folder with a mesh, a glTF file of one material, a picture and a panorama.
struct Assets : TempFolder {
    Assets() {
        EXPECT_TRUE(write_mesh(path / "mesh.ply", tetrahedron()));
        write("thing.gltf",
              R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
                  "materials": [{"name": "gold", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.75, 0.25, 1]}},
                                {"name": "lead"}],
                  "buffers": [{"byteLength": 36, "uri": "thing.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
                  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]})");
        const float triangle[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        write("thing.bin", {reinterpret_cast<const char*>(triangle), sizeof triangle});
        const Image image{2, 1, {Vec4(0.5f, 0.25f, 1, 1), Vec4(0, 0, 0, 1)}, {}};
        EXPECT_TRUE(write_image(path / "picture.png", image));
        EXPECT_TRUE(write_image(path / "sky.exr", image));
    }
};

TEST(SceneFile, TheExampleOfTheFormat) {
    const Scene scene = scene_of(R"({
      "rayuela": 1,  // format version
      "film":   {"width": 640, "height": 480},
      "camera": {"position": [0,1,5], "target": [0,1,0], "up": [0,1,0], "vfov": 40, "lens_radius": 0, "focus_distance": 5},
      "environment": {"type": "gradient", "bottom": [1,1,1], "top": [0.5,0.7,1.0]},
      /* materials */
      "materials": {
        "clay":  {"type": "diffuse", "albedo": [0.7,0.45,0.3]},
        "gold":  {"type": "metal", "albedo": [0.9,0.75,0.45], "roughness": 0.2, "multiscatter": true},
        "glass": {"type": "dielectric", "ior": 1.5, "tint": [1,1,1], "roughness": 0},
        "lamp":  {"type": "emitter", "radiance": [12,11,10], "two_sided": true},
        "pbr":   {"type": "principled", "base_color": "#ff8000", "metallic": 0, "clearcoat": 0.5}
      },
      "objects": [
        {"type": "sphere",   "center": [0,1,0], "radius": 1, "material": "glass", "name": "ball"},
        {"type": "plane",    "point": [0,0,0], "normal": [0,1,0], "material": "clay"},
        {"type": "box",      "min": [0,0,0], "max": [1,1,1], "material": "clay", "visible": false},
        {"type": "triangle", "vertices": [[1,0,0],[0,1,0],[0,0,1]], "material": "clay"},
        {"type": "quad",     "point": [0,0,0], "u": [1,0,0], "v": [0,1,0], "material": "lamp"},
        {"type": "list", "name": "group", "objects": [{"type": "sphere"}, {"type": "list", "objects": [{"type": "box"}]}]}
      ],
      "render": {"max_bounces": 3, "rr_start": 2, "accelerator": "list", "kd_leaf_size": 500, "kd_split": "median",
                 "sampler": "independent", "light_choice": "power", "seed": 4294967295, "max_samples": 64, "max_seconds": 0.1}
    })");
    EXPECT_EQ(scene.film.width, 640);
    EXPECT_TRUE(std::holds_alternative<GradientEnvironment>(scene.environment));
    ASSERT_EQ(scene.materials.size(), 5u);
    EXPECT_EQ(scene.materials[0].name, "clay");  // In the file's order.
    EXPECT_EQ(scene.materials[4].name, "pbr");
    const auto& pbr = std::get<Principled>(scene.materials[4].material);
    EXPECT_FLOAT_EQ(pbr.base_color.value.y, 0.21586052f);  // IEC 61966-2-1 of 128/255.
    EXPECT_EQ(pbr.clearcoat, 0.5f);
    ASSERT_EQ(scene.objects.size(), 9u);
    EXPECT_EQ(scene.objects[0].name, "ball");
    EXPECT_EQ(scene.find(scene.objects[0].material)->name, "glass");
    EXPECT_FALSE(scene.objects[2].visible);
    EXPECT_EQ(std::get<Triangle>(scene.objects[3].shape).vertices[2], Vec3(0, 0, 1));
    EXPECT_EQ(scene.objects[6].parent, scene.objects[5].id);
    EXPECT_EQ(scene.objects[8].parent, scene.objects[7].id);
    EXPECT_EQ(scene.objects[6].name, "Sphere");
    EXPECT_EQ(scene.render.rr_start, 2);
    EXPECT_EQ(scene.render.accel.kind, AcceleratorKind::list);
    EXPECT_EQ(scene.render.accel.leaf_size, 500);
    EXPECT_EQ(scene.render.accel.split, KdSplit::median);
    EXPECT_EQ(scene.render.sampler, SamplerKind::independent);
    EXPECT_EQ(scene.render.light_choice, LightChoice::power);
    EXPECT_EQ(scene.render.seed, 4294967295u);
    EXPECT_EQ(scene.render.max_seconds, 0.1);
    EXPECT_TRUE(validate(scene).empty());
    EXPECT_EQ(scene_of(text_of(scene)), scene);
}

TEST(SceneFile, DefaultsAreLeftOut) {
    EXPECT_EQ(text_of(Scene{}), "{\n  \"rayuela\": 1\n}\n");
    EXPECT_EQ(scene_of(R"({"rayuela": 1})"), Scene{});
    const Scene sphere = scene_of(R"({"rayuela": 1, "objects": [{"type": "sphere", "radius": 2}]})");
    EXPECT_THAT(text_of(sphere), HasSubstr(R"("objects": [{"type": "sphere", "radius": 2}])"));
}

/// The property that a new shape, material or environment is tested by itself: random values of every field come back
/// with the same bits.
TEST(SceneFile, EveryFieldOfEveryKindRoundTrips) {
    testing::Rng rng(1);
    for (int round = 0; round < 100; ++round) {
        Scene scene;
        testing::randomize_fields(rng, scene.camera);
        scene.environment = testing::random_variant<Environment>(rng);
        if (std::holds_alternative<ImageEnvironment>(scene.environment)) scene.environment = NoEnvironment{};
        testing::for_each_random<Material>(rng, [&](const Material& material) {
            const std::uint32_t id = scene.next_id++;
            scene.materials.push_back({MaterialId{id}, "m \"" + std::to_string(id) + "\" \xc3\xa9", material});
        });
        testing::for_each_random<Shape>(rng, [&](const Shape& shape) {
            if (std::holds_alternative<Mesh>(shape) || std::holds_alternative<Gltf>(shape)) return;
            Object object;
            object.shape = shape;
            object.transform = testing::random_transform(rng, shape);
            object.material = scene.materials[rng() % scene.materials.size()].id;
            object.visible = rng() % 2;
            object.id = ObjectId{scene.next_id++};
            object.name = rng() % 2 ? "Sphere 2" : "x" + std::to_string(object.id.value);
            if (!scene.objects.empty() && std::holds_alternative<ObjectList>(scene.objects.back().shape)) {
                object.parent = scene.objects.back().id;
            }
            scene.objects.push_back(object);
        });
        scene.film = {1 + static_cast<int>(rng() % 999), 1 + static_cast<int>(rng() % 999),
                      static_cast<PixelFilter>(rng() % 3)};
        scene.render.max_bounces = static_cast<int>(rng() % 100);
        if (rng() % 2) scene.render.rr_start = static_cast<int>(rng() % 9);
        scene.render.accel = {static_cast<AcceleratorKind>(rng() % 2), 1 + static_cast<int>(rng() % 64),
                              static_cast<KdSplit>(rng() % 2)};
        scene.render.sampler = static_cast<SamplerKind>(rng() % 2);
        scene.render.light_choice = static_cast<LightChoice>(rng() % 3);
        scene.render.seed = static_cast<std::uint32_t>(rng());
        scene.render.max_seconds = static_cast<double>(rng()) / 7;
        ASSERT_TRUE(validate(scene).empty()) << to_string(validate(scene));
        const std::string text = text_of(scene);
        ASSERT_EQ(scene_of(text), scene) << text;
        ASSERT_EQ(text_of(scene_of(text)), text);
    }
}

TEST(SceneFile, TheSignOfZeroSurvives) {
    Scene scene = scene_of(R"({"rayuela": 1, "objects": [{"type": "sphere"}]})");
    std::get<Sphere>(scene.objects[0].shape).center = Vec3(-0.0f, 0, -0.0f);
    const Vec3 read = std::get<Sphere>(scene_of(text_of(scene)).objects[0].shape).center;
    EXPECT_TRUE(std::signbit(read.x));
    EXPECT_FALSE(std::signbit(read.y));
}

TEST(SceneFile, Transforms) {
    const auto transform = [](const std::string& text) {
        return scene_of(R"({"rayuela": 1, "objects": [{"type": "sphere", "transform": )" + text + "}]}")
            .objects[0]
            .transform;
    };
    EXPECT_EQ(transform(R"({"translate": [1, 2, 3]})").affine().point(Vec3(0)), Vec3(1, 2, 3));
    EXPECT_EQ(transform(R"({"scale": 2})").scale, Vec3(2));
    EXPECT_EQ(transform(R"({"scale": [2, 3, -4]})").scale, Vec3(2, 3, -4));
    // A quarter turn about z takes x to y; scale comes first, then rotation, then translation.
    for (const char* rotate :
         {R"({"axis": [0, 0, 2], "degrees": 90})", "[0, 0, 0.70710678, 0.70710678]", "[0, 0, 5, 5]"}) {
        const Transform t =
            transform(std::string(R"({"scale": [2, 1, 1], "translate": [0, 0, 7], "rotate": )") + rotate + "}");
        EXPECT_LT(glm::length(t.affine().point({1, 0, 0}) - Vec3(0, 2, 7)), 1e-6f) << rotate;
    }
    const Transform matrix = transform(R"({"matrix": [2,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]})");
    EXPECT_EQ(matrix.affine().point({1, 1, 1}), Vec3(7, 7, 8));
}

TEST(SceneFile, NamesThatAreGivenByTheReaderAreNotWritten) {
    const std::string text = R"({"rayuela": 1, "objects": [{"type": "sphere"}, {"type": "box", "name": "Sphere 2"},
        {"type": "list", "objects": [{"type": "sphere"}]}, {"type": "sphere"}]})";
    const Scene scene = scene_of(text);
    EXPECT_EQ(scene.objects[0].name, "Sphere");
    EXPECT_EQ(scene.objects[3].name, "Sphere 3");
    EXPECT_EQ(scene.objects[4].name, "Sphere 4");
    EXPECT_THAT(text_of(scene), Not(HasSubstr("Sphere 3")));
    EXPECT_EQ(scene_of(text_of(scene)), scene);
    // Once the first is gone the others cannot be guessed any more.
    const auto removed = apply(scene, RemoveObject{scene.objects[0].id});
    ASSERT_TRUE(removed);
    EXPECT_THAT(text_of(*removed), HasSubstr("Sphere 3"));
    EXPECT_EQ(scene_of(text_of(*removed)).objects[2].name, "Sphere 3");
}

TEST(SceneFile, FilesAreRelativeToTheSceneAndShared) {
    const Assets folder;
    const std::string text = R"({"rayuela": 1, "environment": {"type": "image", "file": "sky.exr", "rotation": 90},
        "materials": {"m": {"type": "principled", "base_color": {"texture": "picture.png", "factor": [1, 0.5, 1]},
                            "roughness": {"texture": "picture.png"}, "metallic": {"texture": "picture.png", "channel": "a"}}},
        "objects": [{"type": "mesh", "file": "mesh.ply", "material": "m"}, {"type": "mesh", "file": "sub/../mesh.ply"}]})";
    const auto file = folder.write("a.scene.json", text);
    AssetCache cache;
    const auto loaded = read_scene(file, &cache);
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    const Scene& scene = loaded->scene;
    const auto& m = std::get<Principled>(scene.materials[0].material);
    EXPECT_EQ(m.base_color.value, Color(1, 0.5f, 1));
    EXPECT_EQ(m.roughness.value, 1);
    EXPECT_EQ(m.roughness.channel, 1);
    EXPECT_EQ(m.metallic.channel, 3);
    EXPECT_EQ(m.roughness.texture, m.metallic.texture);
    EXPECT_NE(m.roughness.texture, m.base_color.texture) << "one is a colour, the other data";
    EXPECT_EQ(std::get<Mesh>(scene.objects[0].shape).data, std::get<Mesh>(scene.objects[1].shape).data);
    EXPECT_EQ(std::get<ImageEnvironment>(scene.environment).image->width, 2);
    // Saved elsewhere the scene finds its files again, and with the cache they are the same.
    std::filesystem::create_directories(folder.path / "other" / "place");
    ASSERT_TRUE(write_scene(folder.path / "other/place/b.scene.json", scene, &cache));
    EXPECT_THAT(testing::slurp(folder.path / "other/place/b.scene.json"), HasSubstr(R"("file": "../../mesh.ply")"));
    const auto again = read_scene(folder.path / "other/place/b.scene.json", &cache);
    ASSERT_TRUE(again) << to_string(again.error());
    EXPECT_EQ(again->scene, scene);
    // A file that changed is read again.
    TriangleMesh moved = tetrahedron();
    moved.positions[1].x = 5;
    ASSERT_TRUE(write_mesh(folder.path / "mesh.ply", moved));
    std::filesystem::last_write_time(folder.path / "mesh.ply",
                                     std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
    const auto changed = read_scene(file, &cache);
    ASSERT_TRUE(changed);
    EXPECT_EQ(std::get<Mesh>(changed->scene.objects[0].shape).data->positions[1].x, 5);
}

TEST(SceneFile, GltfMaterialsCanBeEditedAndSaved) {
    const Assets folder;
    const auto file = folder.write("a.scene.json", R"({"rayuela": 1, "objects": [
        {"type": "sphere", "material": "thing/gold"}, {"type": "gltf", "file": "thing.gltf"}]})");
    auto loaded = read_scene(file);
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    Scene scene = loaded->scene;
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[0].name, "thing/gold");
    EXPECT_EQ(scene.objects[0].material, scene.materials[0].id);
    EXPECT_EQ(std::get<Gltf>(scene.objects[1].shape).materials,
              (std::vector{scene.materials[0].id, scene.materials[1].id}));
    EXPECT_THAT(text_of(scene, folder.path), Not(HasSubstr("materials")))
        << "the file's own materials are not repeated";

    MaterialEntry edited = scene.materials[1];
    edited.material = Diffuse{{Color(0.125f), nullptr}};
    scene = *apply(scene, SetMaterial{edited});
    EXPECT_THAT(text_of(scene, folder.path), HasSubstr(R"("thing/lead": {"type": "diffuse")"));
    EXPECT_THAT(text_of(scene, folder.path), Not(HasSubstr("\"thing/gold\": {")));
    Scene read = scene_of(text_of(scene, folder.path), folder.path);
    EXPECT_EQ(read.find_material("thing/lead")->material, edited.material);
    EXPECT_EQ(std::get<Gltf>(read.objects[1].shape).materials[1], read.find_material("thing/lead")->id);

    edited.name = "my lead";
    scene = *apply(scene, SetMaterial{edited});
    scene = *apply(scene, RemoveMaterial{scene.materials[0].id});
    read = scene_of(text_of(scene, folder.path), folder.path);
    EXPECT_EQ(std::get<Gltf>(read.objects[1].shape).materials,
              (std::vector{MaterialId{}, read.find_material("my lead")->id}));
}

TEST(SceneFile, TwoGltfFilesOfOneName) {
    const Assets folder;
    std::filesystem::create_directory(folder.path / "b");
    for (const char* name : {"thing.gltf", "thing.bin"})
        std::filesystem::copy(folder.path / name, folder.path / "b" / name);
    const auto file = folder.write("a.scene.json", R"({"rayuela": 1, "objects": [
        {"type": "gltf", "file": "thing.gltf"}, {"type": "gltf", "file": "b/thing.gltf"}, {"type": "gltf", "file": "thing.gltf"}]})");
    const auto loaded = read_scene(file);
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    EXPECT_EQ(loaded->scene.materials.size(), 4u);
    EXPECT_NE(loaded->scene.find_material("thing 2/gold"), nullptr);
    EXPECT_EQ(std::get<Gltf>(loaded->scene.objects[0].shape), std::get<Gltf>(loaded->scene.objects[2].shape));
}

TEST(SceneFile, ObjectFilesOpenAsScenes) {
    const Assets folder;
    for (const char* name : {"mesh.ply", "thing.gltf"}) {
        const auto loaded = read_scene(folder.path / name);
        ASSERT_TRUE(loaded) << to_string(loaded.error());
        EXPECT_TRUE(validate(loaded->scene).empty());
        EXPECT_EQ(loaded->scene.objects.size(), 1u);
        EXPECT_FALSE(loaded->scene.materials.empty());
        EXPECT_TRUE(std::holds_alternative<GradientEnvironment>(loaded->scene.environment));
        // Every corner of the bounds lies before the camera, within its opening.
        const Camera& camera = loaded->scene.camera;
        const Vec3 forward = glm::normalize(camera.target - camera.position);
        const Bounds3 bounds = world_bounds(loaded->scene);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p(corner & 1 ? bounds.hi.x : bounds.lo.x, corner & 2 ? bounds.hi.y : bounds.lo.y,
                         corner & 4 ? bounds.hi.z : bounds.lo.z);
            EXPECT_GT(glm::dot(glm::normalize(p - camera.position), forward), std::cos(glm::radians(camera.vfov) / 2));
        }
    }
    EXPECT_TRUE(is_scene_file("a.scene.json"));
    EXPECT_TRUE(is_scene_file("a.GLB"));
    EXPECT_FALSE(is_scene_file("a.txt"));
}

TEST(SceneFile, ObjectFilesJoinAScene) {
    const Assets folder;
    AssetCache cache;
    Scene scene = scene_of(R"({"rayuela": 1, "objects": [{"type": "sphere"}]})");
    for (int i = 0; i < 2; ++i) {
        for (const char* name : {"mesh.ply", "thing.gltf"}) {
            const auto object = load_object_file(folder.path / name, &cache);
            ASSERT_TRUE(object) << to_string(object.error());
            const auto added = add_to_scene(scene, *object);
            ASSERT_TRUE(added) << to_string(added.error());
            scene = *added;
            ASSERT_TRUE(validate(scene).empty()) << to_string(validate(scene));
        }
    }
    ASSERT_EQ(scene.objects.size(), 5u);
    EXPECT_EQ(scene.objects[1].name, "mesh");
    EXPECT_EQ(scene.objects[3].name, "mesh 2");
    EXPECT_EQ(scene.materials.size(), 2u) << "the same file brings its materials once";
    EXPECT_EQ(scene.objects[2].shape, scene.objects[4].shape);
    EXPECT_THAT(to_string(load_object_file(folder.path / "none.obj").error()), HasSubstr("no such file"));
}

TEST(SceneFile, AFailedSaveKeepsTheOldFile) {
    const TempFolder folder;
    const auto file = folder.write("a.scene.json", "old");
    Scene scene = scene_of(R"({"rayuela": 1, "objects": [{"type": "sphere"}]})");
    scene.objects[0].shape = Mesh{"", std::make_shared<TriangleMesh>(tetrahedron())};
    const auto written = write_scene(file, scene);
    ASSERT_FALSE(written);
    EXPECT_THAT(to_string(written.error()), HasSubstr("a.scene.json: Sphere: the mesh came from no file"));
    EXPECT_EQ(testing::slurp(file), "old");
    std::get<Mesh>(scene.objects[0].shape).file = "x.obj";
    scene.film.width = 0;
    EXPECT_THAT(to_string(write_scene(file, scene).error()), HasSubstr("film.width: must be >= 1, is 0"));
}

}  // namespace
}  // namespace rayuela
