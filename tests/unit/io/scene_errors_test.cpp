#include "core/io/image_io.h"
#include "core/io/json.h"
#include "core/io/scene_reader.h"
#include "core/scene/scene_edit.h"
#include "tests/unit/io/temp_folder.h"

#include <gmock/gmock.h>

namespace rayuela {
namespace {

using ::testing::HasSubstr;

std::string errors_of(const std::string& text, const std::filesystem::path& base = "/none") {
    const auto loaded = scene_from_json(text, base, "a.scene.json");
    return loaded ? "no error" : to_string(loaded.error());
}

std::string with_object(const std::string& members) {
    return R"({"rayuela": 1, "materials": {"clay": {"type": "diffuse"}}, "objects": [{)" + members + "}]}";
}

TEST(SceneErrors, EachNamesPlaceAndCause) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"", "a.scene.json: line 1, column 1: "},
        {"{\"rayuela\": 1,\n  \"film\": {]}", "a.scene.json: line 2, column 12: syntax error"},
        {"[]", "must be an object, is an array"},
        {"{}", "rayuela: the format version must be 1, is missing"},
        {R"({"rayuela": 2})", "rayuela: the format version must be 1, is 2"},
        {R"({"rayuela": "1"})", "rayuela: the format version must be 1, is a text"},
        {R"({"rayuela": 1, "film": {"width": 0}})", "film.width: must be >= 1, is 0"},
        {R"({"rayuela": 1, "film": {"width": 1.5}})", "film.width: must be a whole number, is 1.5"},
        {R"({"rayuela": 1, "film": {"width": 1e9}})", "film.width: must be <= 16384, is 1"},
        {R"({"rayuela": 1, "film": {"filter": "triangle"}})",
         "film.filter: 'triangle' is unknown; known are box, tent, gaussian"},
        {R"({"rayuela": 1, "film": {"wdith": 5}})", "film.wdith: unknown key; known are width, height, filter"},
        {R"({"rayuela": 1, "flim": {}})", "flim: unknown key; known are rayuela, film, camera"},
        {R"({"rayuela": 1, "film": 5})", "film: must be an object, is a number"},
        {R"({"rayuela": 1, "film": {}, "film": {}})", "film: is given twice"},
        {R"({"rayuela": 1, "materials": {"a": {"type": "diffuse"}, "a": {"type": "metal"}}})",
         "materials.a: is given twice"},
        {R"({"rayuela": 1, "camera": {"vfov": 180}})", "camera.vfov: must be <= 179.9, is 180"},
        {R"({"rayuela": 1, "camera": {"up": [0, 0, 0]}})", "camera.up: must not be zero"},
        {R"({"rayuela": 1, "camera": {"target": [0, 1, 5]}})", "camera.target: must differ from the position"},
        {R"({"rayuela": 1, "camera": {"position": [0, 1]}})", "camera.position: must be 3 numbers, are 2"},
        {R"({"rayuela": 1, "camera": {"position": [0, 1, null]}})", "camera.position: must be an array of 3 numbers"},
        {R"({"rayuela": 1, "camera": {"position": [0, 1e39, 0]}})", "camera.position: must be a finite number, is inf"},
        {R"({"rayuela": 1, "camera": {"focus_distance": 0}})", "camera.focus_distance: must be > 0, is 0"},
        {R"({"rayuela": 1, "camera": {"position": [0, NaN, 0]}})", "line 1, column 43: syntax error"},
        {R"({"rayuela": 1, "camera": {"vfov": 1e400}})", "number overflow"},
        {R"({"rayuela": 1, "environment": {"type": "sky"}})",
         "environment.type: 'sky' is unknown; known are none, constant"},
        {R"({"rayuela": 1, "environment": {}})", "environment.type: is missing; known are"},
        {R"({"rayuela": 1, "environment": {"type": "constant", "radiance": [-1, 0, 0]}})",
         "environment.radiance: must be >= 0, is -1"},
        {R"({"rayuela": 1, "environment": {"type": "image"}})", "environment.file: is missing"},
        {R"({"rayuela": 1, "environment": {"type": "image", "file": "no.exr"}})",
         "environment.file: /none/no.exr: no such file"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": [0.5, 1.5, 0]}}})",
         "materials.m.albedo: must be <= 1, is 1.5"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": "#12345"}}})",
         "materials.m.albedo: '#12345' is no colour"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": "#12345g"}}})", "'#12345g' is no colour"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": "#-12345"}}})", "'#-12345' is no colour"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": 0.5}}})",
         "albedo: must be an array of 3 numbers, is a number"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "metal", "multiscatter": 1}}})",
         "must be true or false, is a number"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "metal", "roughness": {"texture": "no.png"}}}})",
         "materials.m.roughness.texture: /none/no.png: no such file"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "metal", "roughness": {"factor": 1}}}})",
         "roughness.texture: is missing"},
        {R"({"rayuela": 1, "materials": {"m": {"type": "dielectric", "ior": {"texture": "no.png"}}}})",
         "ior: must be a number, is an object"},
        {R"({"rayuela": 1, "materials": {"": {"type": "metal"}}})", "a material must have a name"},
        {R"({"rayuela": 1, "materials": []})", "materials: must be an object, is an array"},
        {R"({"rayuela": 1, "objects": {}})", "objects: must be an array, is an object"},
        {R"({"rayuela": 1, "objects": [5]})", "objects[0]: must be an object, is a number"},
        {with_object(R"("type": "sphere", "radius": -1)"), "a.scene.json: objects[0].radius: must be > 0, is -1"},
        {with_object(R"("type": "sphere", "radius": "big")"), "objects[0].radius: must be a number, is a text"},
        {with_object(R"("type": "sphere", "material": "cley")"), "objects[0].material: there is no material 'cley'"},
        {with_object(R"("type": "sphere", "material": 5)"),
         "objects[0].material: must be the name of a material, is a number"},
        {with_object(R"("type": "sphere", "visible": "no")"), "objects[0].visible: must be true or false, is a text"},
        {with_object(R"("type": "sphere", "name": 5)"), "objects[0].name: must be a text, is a number"},
        {with_object(R"("type": "sphere", "objects": [])"), "objects[0].objects: unknown key"},
        {with_object(R"("type": "list", "objects": [{"type": "sphere", "radius": 0}])"),
         "objects[0].objects[0].radius: must be > 0"},
        {with_object(R"("type": "box", "min": [0, 2, 0], "max": [1, 1, 1])"),
         "objects[0].min: must be <= max in y, is 2 > 1"},
        {with_object(R"("type": "plane", "normal": [0, 0, 0])"), "objects[0].normal: must not be zero"},
        {with_object(R"("type": "triangle", "vertices": [[0, 0, 0], [1, 1, 1]])"),
         "objects[0].vertices: must be 3 points"},
        {with_object(R"("type": "triangle", "vertices": [[0, 0, 0], [1, 1, 1], [2]])"),
         "objects[0].vertices[2]: must be 3 numbers, are 1"},
        {with_object(R"("type": "mesh")"), "objects[0].file: is missing"},
        {with_object(R"("type": "mesh", "file": "")"), "objects[0].file: must name a file"},
        {with_object(R"("type": "mesh", "file": "no.obj")"), "objects[0].file: /none/no.obj: no such file"},
        {with_object(R"("type": "mesh", "file": "no.stl")"), "unknown mesh extension '.stl'"},
        {with_object(R"("type": "gltf", "file": "no.glb")"), "objects[0].file: /none/no.glb: no such file"},
        {with_object(R"("type": "sphere", "transform": {"scale": 0})"), "objects[0].transform.scale: must not be 0"},
        {with_object(R"("type": "sphere", "transform": {"scale": [1, 2]})"),
         "transform.scale: must be 3 numbers, are 2"},
        {with_object(R"("type": "sphere", "transform": {"rotate": [0, 0, 0, 0]})"),
         "rotate: must be a quaternion other than zero"},
        {with_object(R"("type": "sphere", "transform": {"rotate": {"axis": [0, 0, 0], "degrees": 5}})"),
         "with an axis other than zero"},
        {with_object(R"("type": "sphere", "transform": {"rotate": {"axis": [0, 0, 1]}})"),
         "rotate: needs an axis and degrees"},
        {with_object(R"("type": "sphere", "transform": {"turn": 1})"), "transform.turn: unknown key"},
        {with_object(R"("type": "sphere", "transform": {"matrix": [1]})"),
         "transform.matrix: must be 16 numbers, are 1"},
        {with_object(R"("type": "sphere", "transform": {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]})"),
         "its last row must be 0 0 0 1"},
        {with_object(R"("type": "sphere", "transform": {"matrix": [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]})"),
         "matrix: must be invertible"},
        {with_object(R"("type": "sphere", "transform": {"scale": 2, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})"),
         "stands instead of translate, rotate and scale"},
        {with_object(R"("type": "plane", "transform": {"scale": 2})"),
         "scale: a plane takes rotation and translation only"},
        {R"({"rayuela": 1, "render": {"kd_leaf_size": 0}})", "render.kd_leaf_size: must be >= 1, is 0"},
        {R"({"rayuela": 1, "render": {"kd_leaf_size": -3}})", "render.kd_leaf_size: must be >= 1, is -3"},
        {R"({"rayuela": 1, "render": {"seed": 4294967296}})", "render.seed: must be <= 4294967295, is 4294967296"},
        {R"({"rayuela": 1, "render": {"max_seconds": -1}})", "render.max_seconds: must be >= 0, is -1"},
        {R"({"rayuela": 1, "render": {"accelerator": 5}})", "render.accelerator: must be a text, is a number"},
    };
    for (const auto& [text, message] : cases) EXPECT_THAT(errors_of(text), HasSubstr(message)) << text;
}

TEST(SceneErrors, AllOfAFileAreListed) {
    const std::string errors =
        errors_of(R"({"rayuela": 1, "film": {"width": -1, "hight": 5}, "camera": {"vfov": "wide"},
        "materials": {"a": {"type": "metal", "roughness": 2}}, "objects": [{"type": "sphere", "radius": 0, "material": "b"},
        {"type": "cone"}, {"type": "mesh", "file": "x.obj"}], "render": {"max_bounces": -1}})");
    for (const char* place :
         {"film.width:", "film.hight:", "camera.vfov:", "materials.a.roughness:", "objects[0].radius:",
          "objects[0].material:", "objects[1].type:", "objects[2].file:", "render.max_bounces:"}) {
        EXPECT_THAT(errors, HasSubstr(place));
    }
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 8);
}

TEST(SceneErrors, BrokenFilesOfAScene) {
    const testing::TempFolder folder;
    folder.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    folder.write("bad.png", "no picture");
    const std::string errors = errors_of(
        R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": {"texture": "bad.png"}}},
            "objects": [{"type": "mesh", "file": "bad.obj"}]})",
        folder.path);
    EXPECT_THAT(errors,
                HasSubstr("materials.m.albedo.texture: " + (folder.path / "bad.png").string() + ": is no image"));
    EXPECT_THAT(errors, HasSubstr("objects[0].file: " + (folder.path / "bad.obj").string() +
                                  ": line 2: vertex 2 does not exist"));
}

TEST(SceneErrors, ABrokenImageThatNothingShowsIsTold) {
    const testing::TempFolder folder;
    ASSERT_TRUE(write_image(folder.path / "a.png", Image{64, 64, std::vector<Vec4>(64 * 64, Vec4(0.5f)), {}}));
    const std::string bytes = testing::slurp(folder.path / "a.png");
    folder.write("bad.png", std::string_view(bytes).substr(0, bytes.size() / 2));
    const std::string errors = errors_of(
        R"({"rayuela": 1, "materials": {"m": {"type": "diffuse", "albedo": {"texture": "bad.png"}}}})", folder.path);
    EXPECT_THAT(errors, HasSubstr("materials.m.albedo.texture: " + (folder.path / "bad.png").string() + ": "));
}

TEST(SceneErrors, FilesThatAreNoScenes) {
    const testing::TempFolder folder;
    EXPECT_THAT(to_string(read_scene(folder.path / "a.blend").error()), HasSubstr("unknown extension '.blend'"));
    EXPECT_THAT(to_string(read_scene(folder.path / "a.scene.json").error()), HasSubstr("a.scene.json: no such file"));
    EXPECT_THAT(to_string(read_scene(folder.write("a.ply", "ply")).error()), HasSubstr("a.ply: line 1"));
}

TEST(SceneErrors, DeepNestingIsRefused) {
    const std::string open(100000, '['), close(100000, ']');
    EXPECT_THAT(errors_of(R"({"rayuela": 1, "objects": )" + open + close + "}"), HasSubstr("nested too deeply"));
    EXPECT_THAT(errors_of(open), HasSubstr("nested too deeply"));
}

TEST(SceneErrors, EveryTruncationAndManyMutationsAreSurvived) {
    const std::string text =
        R"({"rayuela": 1, "film": {"width": 5, "filter": "tent"}, "environment": {"type": "constant"},
        "materials": {"a": {"type": "metal", "roughness": 0.5, "albedo": "#102030"}}, "objects": [{"type": "list", "objects":
        [{"type": "sphere", "radius": 1e-3, "material": "a", "transform": {"rotate": [0, 0, 0, 1]}}]}], "render": {"seed": 7}})";
    for (std::size_t size = 0; size < text.size(); ++size)
        EXPECT_NE(errors_of(text.substr(0, size)), "no error") << size;
    std::uint32_t state = 1;
    const auto next = [&](std::size_t n) { return (state = state * 1664525u + 1013904223u) / 65536u % n; };
    for (int i = 0; i < 5000; ++i) {
        std::string mutated = text;
        for (int k = 0; k < 2; ++k) mutated[next(text.size())] = static_cast<char>(next(128));
        const auto loaded = scene_from_json(mutated, "/none", "a");
        if (loaded) {
            EXPECT_TRUE(validate(loaded->scene).empty()) << mutated;
        }
    }
}

TEST(Json, TextIsReadBack) {
    const std::string text = R"({"a": [1, 2.5, -3e-7], "b": {"c": null, "d": "e \"\\ \u00e9"}, "f": true})";
    const auto json = parse_json(text, "x");
    ASSERT_TRUE(json);
    const auto again = parse_json(to_text(*json), "x");
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, *json);
    EXPECT_EQ(json_depth(R"({"a": "[[[[", "b": [{"c": 1}]})"), 3);
}

}  // namespace
}  // namespace rayuela
