#include "core/io/mesh_io.h"

#include "core/io/mesh_builder.h"
#include "core/io/obj_reader.h"
#include "core/io/ply_reader.h"
#include "core/io/put_aside.h"
#include "tests/unit/io/temp_folder.h"

#include <gmock/gmock.h>

#include <bit>
#include <random>

namespace rayuela {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TempFolder;

std::string error_of(const MeshResult& result) {
    return result ? "no error" : to_string(result.error());
}

/// Twice the signed area along z: what must not change however a polygon is cut.
double area(const std::vector<Vec3>& positions, const std::vector<glm::uvec3>& triangles) {
    double sum = 0;
    for (const glm::uvec3& t : triangles) {
        sum += glm::cross(Vec3d(positions[t.y] - positions[t.x]), Vec3d(positions[t.z] - positions[t.x])).z;
    }
    return sum;
}

std::vector<glm::uvec3> cut(const std::vector<Vec3>& polygon) {
    std::vector<std::uint32_t> corners(polygon.size());
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
    std::vector<glm::uvec3> triangles;
    triangulate(corners, polygon, triangles);
    return triangles;
}

TEST(Triangulate, ConcavePolygonsKeepTheirArea) {
    // An L of area 3, a comb with three teeth of area 3 * 2 + 5 * 1, a dart of area 3/2: none is a fan from its corner 0.
    const std::vector<std::pair<std::vector<Vec3>, double>> cases = {
        {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 3},
        {{{0, 0, 0},
          {5, 0, 0},
          {5, 3, 0},
          {4, 3, 0},
          {4, 1, 0},
          {3, 1, 0},
          {3, 3, 0},
          {2, 3, 0},
          {2, 1, 0},
          {1, 1, 0},
          {1, 3, 0},
          {0, 3, 0}},
         11},
        {{{2, 0, 0}, {0, 2, 0}, {0.5f, 0.5f, 0}, {0, 0, 0}}, 1.5},
    };
    for (const auto& [polygon, expected] : cases) {
        for (std::size_t shift = 0; shift < polygon.size(); ++shift) {
            std::vector<Vec3> turned = polygon;
            std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(shift), turned.end());
            const auto triangles = cut(turned);
            EXPECT_EQ(triangles.size(), polygon.size() - 2);
            EXPECT_NEAR(area(turned, triangles) / 2, expected, 1e-6);
            for (const glm::uvec3& t : triangles) EXPECT_GE(area(turned, {t}), 0) << "a triangle is turned round";
        }
    }
}

TEST(Triangulate, TinyPolygonsAreCutLikeLargeOnes) {
    const std::vector<Vec3> ell = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
    std::vector<Vec3> tiny;
    for (const Vec3& p : ell) tiny.push_back(0x1p-40f * p);
    EXPECT_EQ(cut(ell), cut(tiny));
}

TEST(Triangulate, DegenerateAndCrossingPolygonsGiveTheRightCount) {
    EXPECT_EQ(cut(std::vector<Vec3>(7, Vec3(1, 2, 3))).size(), 5u);
    EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
    std::vector<Vec3> many;
    for (int i = 0; i < 5000; ++i) many.emplace_back(i, i % 3, i % 7);
    EXPECT_EQ(cut(many).size(), 4998u);
}

TEST(Obj, PolygonsNegativeIndicesGroupsAndComments) {
    const auto mesh = parse_obj(
        "# a quad and a triangle\n"
        "mtllib none.mtl\r\n"
        "o thing\nv 0 0 0\nv 1 0 0   # first edge\nv 1 1 0\nv 0 1 0\n"
        "g left\nusemtl red\nf 1 2 3 4\n"
        "g right\nv 0 0 1\nf -1 -5 -4 # relative\n",
        "a.obj");
    ASSERT_TRUE(mesh) << error_of(mesh);
    EXPECT_EQ((*mesh)->positions.size(), 5u);
    ASSERT_EQ((*mesh)->triangles.size(), 3u);
    const auto& last = (*mesh)->triangles[2];
    EXPECT_EQ((*mesh)->positions[last.x], Vec3(0, 0, 1));
    EXPECT_EQ((*mesh)->positions[last.y], Vec3(0, 0, 0));
    EXPECT_EQ((*mesh)->positions[last.z], Vec3(1, 0, 0));
    EXPECT_TRUE((*mesh)->normals.empty());
    EXPECT_TRUE((*mesh)->uvs.empty());
    EXPECT_EQ((*mesh)->bounds.hi, Vec3(1, 1, 1));
}

TEST(Obj, TuplesBecomeVertices) {
    const auto mesh = parse_obj(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 -2\n"
        "f 1/1/1 2/2/1 3/3/1\nf 2/2/1 4/1/1 3/3/1\nf 2//1 4//1 3//1\n",
        "a.obj");
    ASSERT_TRUE(mesh) << error_of(mesh);
    // (1,1) (2,2) (3,3) (4,1) and the three of the last face, which have no uv.
    EXPECT_EQ((*mesh)->positions.size(), 7u);
    EXPECT_EQ((*mesh)->normals, std::vector<Vec3>(7, Vec3(0, 0, -1)));
    EXPECT_EQ((*mesh)->uvs[1], Vec2(1, 0));
}

TEST(Obj, MissingNormalsBecomeThoseOfAFaceWithAWarning) {
    Problems warnings;
    const auto mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn 0 0 0\nf 1//1 2 3//2\n", "a.obj", &warnings);
    ASSERT_TRUE(mesh) << error_of(mesh);
    EXPECT_EQ((*mesh)->normals[0], Vec3(1, 0, 0));
    EXPECT_EQ((*mesh)->normals[1], Vec3(0, 0, 1));
    EXPECT_EQ((*mesh)->normals[2], Vec3(0, 0, 1));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0].message(), HasSubstr("a.obj: vertex 1: 2 normals"));
}

/// Two triangles in different planes, with normals of their own at the three corners of each.
std::string bent_obj(const std::string& second_normal) {
    return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn " + second_normal +
           "\nf 1//1 2//1 3//1\nf 2//2 3//2 4//2\n";
}

TEST(Obj, NormalsOfFacesAreNotKept) {
    // As far as six digits say it: not as far as a float.
    for (const auto& [normal, kept] :
         {std::pair("-1 -1 -1", std::size_t{6}), std::pair("0 0 1", std::size_t{6}),
          std::pair("0.577350 0.577350 0.577351", std::size_t{6}),
          std::pair("0.57735027 0.57735027 0.57735027", std::size_t{0}), std::pair("1 1 1", std::size_t{0})}) {
        const auto mesh = parse_obj(bent_obj(normal), "a.obj");
        ASSERT_TRUE(mesh) << error_of(mesh);
        EXPECT_EQ((*mesh)->normals.size(), kept) << normal;
        EXPECT_EQ((*mesh)->positions.size(), 6u);
    }
}

TEST(Obj, ErrorsNameTheLine) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::vector<std::pair<std::string, std::string>> cases = {
        {vertices + "f 1 2 4\n", "a.obj: line 4: vertex 4 does not exist, there are 3"},
        {vertices + "f 1 2 0\n", "line 4: vertex 0 does not exist"},
        {vertices + "f -1 -2 -4\n", "line 4: vertex 0 does not exist"},
        {vertices + "f -1 -2 -5\n", "line 4: vertex -1 does not exist"},
        {vertices + "f 1//1 2//1 3//1\n", "line 4: normal 1 does not exist, there are 0"},
        {vertices + "f 1/-1 2/-1 3/-1\n", "line 4: texture coordinate -1 does not exist"},
        {vertices + "f 1 2\n", "line 4: has 2 numbers where 3 are needed"},
        {vertices + "f 1 two 3\n", "line 4: 'two' is no number"},
        {vertices + "f 4294967297 2 3\n", "line 4: the index 4294967297 is too large"},
        {vertices + "v 1 nan 0\nf 1 2 3\n", "line 4: 'nan' is no number"},
        {vertices + "v 1 1e99 0\nf 1 2 3\n", "line 4: the vertex is not finite"},
        {vertices + "v 1 2\nf 1 2 3\n", "line 4: has 2 numbers where 3 are needed"},
        {vertices, "has no faces"},
        {"", "has no faces"},
        {std::string("\0\xff garbage \n\n", 13), "has no faces"},
    };
    for (const auto& [text, message] : cases)
        EXPECT_THAT(error_of(parse_obj(text, "a.obj")), HasSubstr(message)) << text;
}

TEST(Obj, ErrorsComeInTheOrderOfTheLines) {
    const auto mesh = parse_obj("v 0 0 0 # a comment\r\nv 1e99 0 0\r\nf 1 x 2\nv 0 1e99 0\nvn 1 2\nf 1 2 9", "a.obj");
    ASSERT_FALSE(mesh);
    std::vector<std::string> places;
    for (const Problem& problem : mesh.error()) places.push_back(problem.place);
    EXPECT_THAT(places, ElementsAre("line 2", "line 3", "line 4", "line 5"));
    std::string many;
    for (int i = 0; i < 20; ++i) many += i % 2 ? "v 1 2\n" : "v 1 2 1e99\n";
    const auto cut = parse_obj(many, "a.obj");
    ASSERT_FALSE(cut);
    ASSERT_EQ(cut.error().size(), 10u);
    EXPECT_EQ(cut.error().back().place, "line 10");
}

TEST(Obj, ForwardReferencesAndContinuedLines) {
    const auto mesh = parse_obj("f 1 2 \\\n3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj");
    ASSERT_TRUE(mesh) << error_of(mesh);
    EXPECT_EQ((*mesh)->triangles.size(), 1u);
}

const std::string kPlyHeader =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(Ply, Ascii) {
    const auto mesh = parse_ply(
        "ply\nformat ascii 1.0\ncomment made by hand\n"
        "element vertex 4\nproperty double x\nproperty float y\nproperty float z\nproperty uchar red\n"
        "property float s\nproperty float t\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
        "element face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\nend_header\n"
        "0 0 0 255 0 0\n1 0 0 255 1 0\n1 1 +0 255 1 1\n0 1e0 0 255 0 1\n7 8\n3 4 0 1 2 3\n",
        "a.ply");
    ASSERT_TRUE(mesh) << error_of(mesh);
    EXPECT_EQ((*mesh)->triangles.size(), 2u);
    EXPECT_EQ((*mesh)->positions[2], Vec3(1, 1, 0));
    EXPECT_EQ((*mesh)->uvs[3], Vec2(0, 1));
    EXPECT_EQ(area((*mesh)->positions, (*mesh)->triangles), 2);
}

TEST(Ply, BinaryOfBothByteOrders) {
    for (const bool big : {false, true}) {
        std::string bytes =
            std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kPlyHeader;
        const auto put = [&](auto value) {
            std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
            if (big) std::reverse(raw.begin(), raw.end());
            bytes += raw;
        };
        for (const float f : {0.0f, 0.0f, 0.0f, 1.5f, 0.0f, 0.0f, 0.0f, 2.5f, -1.0f}) put(f);
        put(std::uint8_t{3});
        for (const std::int32_t i : {0, 1, 2}) put(i);
        const auto mesh = parse_ply(bytes, "a.ply");
        ASSERT_TRUE(mesh) << error_of(mesh);
        EXPECT_EQ((*mesh)->positions[2], Vec3(0, 2.5f, -1));
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            EXPECT_FALSE(parse_ply(std::string_view(bytes).substr(0, size), "a.ply")) << size;
        }
    }
}

/// Files of floats and triangles are taken as they stand; what differs in anything is read number by number.
TEST(Ply, PlainFilesAreReadLikeOthers) {
    const auto file = [](const std::string& type, const std::string& flag, std::vector<float> values,
                         std::vector<std::int32_t> indices) {
        std::string bytes =
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float nx\nproperty float ny\n"
            "property float nz\nproperty float x\nproperty float confidence\nproperty float y\n"
            "property " +
            type + " z\nelement face 1\nproperty list uchar int vertex_indices\n" + flag + "end_header\n";
        const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (type == "double" && i % 7 == 6) {
                put(double{values[i]});
            } else {
                put(values[i]);
            }
        }
        put(static_cast<std::uint8_t>(indices.size()));
        for (const std::int32_t index : indices) put(index);
        if (!flag.empty()) put(std::uint8_t{1});
        return parse_ply(bytes, "a.ply");
    };
    const std::vector<float> values{0.6f, 0, 0.8f, 1, 9, 2, 3, 0, 1, 0, 4, 9, 5, 6.5f, 1, 0, 0, -7, 9, 8, 9};
    const auto plain = file("float", "", values, {2, 0, 1});
    ASSERT_TRUE(plain) << error_of(plain);
    EXPECT_EQ((*plain)->positions, (std::vector{Vec3(1, 2, 3), Vec3(4, 5, 6.5f), Vec3(-7, 8, 9)}));
    EXPECT_EQ((*plain)->normals, (std::vector{Vec3(0.6f, 0, 0.8f), Vec3(0, 1, 0), Vec3(1, 0, 0)}));
    EXPECT_EQ((*plain)->triangles, std::vector{glm::uvec3(2, 0, 1)});
    for (const auto& other :
         {file("double", "", values, {2, 0, 1}), file("float", "property uchar flag\n", values, {2, 0, 1})}) {
        ASSERT_TRUE(other) << error_of(other);
        EXPECT_EQ((*other)->positions, (*plain)->positions);
        EXPECT_EQ((*other)->normals, (*plain)->normals);
        EXPECT_EQ((*other)->triangles, (*plain)->triangles);
    }
    EXPECT_EQ((*file("float", "", values, {2, 0, 1, 2}))->triangles.size(), 2u);
    EXPECT_THAT(error_of(file("float", "", values, {2, 0, 3})), HasSubstr("face 0: vertex 3 does not exist"));
    EXPECT_THAT(error_of(file("float", "", values, {2, -1, 1})), HasSubstr("face 0: vertex -1 does not exist"));
    std::vector<float> broken = values;
    broken[10] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(error_of(file("float", "", broken, {2, 0, 1})), HasSubstr("vertex 1: is not finite"));
}

TEST(Ply, ErrorsNameThePlace) {
    const std::string ascii = "ply\nformat ascii 1.0\n";
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n";
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"", "does not begin with 'ply'"},
        {"plz\n", "line 1: does not begin with 'ply'"},
        {"ply\nformat ascii 1.0\n", "the header has no end"},
        {"ply\nend_header\n", "names no format"},
        {"ply\nformat morse 1.0\n", "line 2: unknown format 'morse'"},
        {ascii + "element vertex -3\n", "line 3: '-3' is no count"},
        {ascii + "element vertex 1\nproperty quad x\n", "line 4: unknown property type"},
        {ascii + "surprise\n", "line 3: 'surprise' is not understood"},
        {ascii + kPlyHeader + body + "3 0 1 3\n", "face 0: vertex 3 does not exist, there are 3"},
        {ascii + kPlyHeader + body + "3 0 1 -1\n", "face 0: vertex -1 does not exist"},
        {ascii + kPlyHeader + body + "2 0 1\n", "face 0: has 2 vertices, needs 3"},
        {ascii + kPlyHeader + body + "-3 0 1 2\n", "face 0: a list of -3 items"},
        {ascii + kPlyHeader + body + "200 0 1 2\n", "face 0: a list of 200 items does not fit"},
        {ascii + kPlyHeader + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1: is not finite"},
        {ascii + kPlyHeader + "0 0 0\n1 x 0\n", "vertex 1: y is no number"},
        {ascii + kPlyHeader + "0 0 0\n1 0\n", "vertex 1: is cut off"},
        {ascii + "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float "
                 "z\nend_header\n1 2 3\n",
         "vertex 1: is cut off"},
        {ascii + "element vertex 1\nproperty float x\nend_header\n1\n", "vertex: has no property x, y or z"},
        {ascii + "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
         "has no faces"},
    };
    for (const auto& [text, message] : cases)
        EXPECT_THAT(error_of(parse_ply(text, "a.ply")), HasSubstr(message)) << text;
}

TriangleMesh random_mesh() {
    std::mt19937 rng(3);
    std::uniform_int_distribution<std::uint32_t> bits;
    const auto number = [&] {
        for (;;) {
            const float f = std::bit_cast<float>(bits(rng));
            if (std::abs(f) < 1e30f && std::abs(f) > 1e-30f) return f;
        }
    };
    TriangleMesh mesh;
    for (int i = 0; i < 300; ++i) {
        mesh.positions.emplace_back(number(), number(), number());
        mesh.normals.push_back(glm::normalize(Vec3(bits(rng) % 100 + 1.0f, bits(rng) % 100, bits(rng) % 100)));
        mesh.uvs.emplace_back(number(), number());
    }
    for (std::uint32_t i = 0; i < 300; i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
    return mesh;
}

TEST(WriteMesh, ReadingGivesTheSameFloats) {
    const TempFolder folder;
    TriangleMesh mesh = random_mesh();
    for (const bool with_normals : {true, false}) {
        for (const bool with_uvs : {true, false}) {
            TriangleMesh written = mesh;
            if (!with_normals) written.normals.clear();
            if (!with_uvs) written.uvs.clear();
            for (const char* name : {"a.ply", "a.obj"}) {
                ASSERT_TRUE(write_mesh(folder.path / name, written));
                const auto read = read_mesh(folder.path / name);
                ASSERT_TRUE(read) << error_of(read);
                EXPECT_EQ((*read)->positions, written.positions) << name;
                EXPECT_EQ((*read)->normals, written.normals) << name;
                EXPECT_EQ((*read)->uvs, written.uvs) << name;
                EXPECT_EQ((*read)->triangles, written.triangles) << name;
            }
        }
    }
}

TEST(ReadMesh, ManyTextureCoordinatesArePutAside) {
    const TempFolder folder;
    TriangleMesh mesh;
    constexpr std::uint32_t kVertices = kSmallestAside / sizeof(Vec2);
    for (std::uint32_t i = 0; i < kVertices; ++i) {
        const auto x = static_cast<float>(i);
        mesh.positions.emplace_back(x, x * x, 1);
        mesh.uvs.emplace_back(1 / (x + 1), -x);
    }
    mesh.triangles.emplace_back(0, 1, kVertices - 1);
    ASSERT_TRUE(write_mesh(folder.path / "a.ply", mesh));
    const auto read = read_mesh(folder.path / "a.ply");
    ASSERT_TRUE(read) << error_of(read);
    std::filesystem::remove(folder.path / "a.ply");  // It is not needed any more.
    const TriangleMesh& aside = **read;
    ASSERT_TRUE(aside.uvs_aside) << "no file could be had in /var/tmp nor in /tmp";
    EXPECT_TRUE(aside.has_uvs());
    EXPECT_EQ(aside.uvs.capacity(), 0u);
    EXPECT_EQ(aside.bytes_aside(), mesh.uvs.size() * sizeof(Vec2));
    EXPECT_EQ(aside.memory_bytes() + aside.bytes_aside(), mesh.memory_bytes());
    {
        const auto uvs = uvs_of(*read);
        ASSERT_TRUE(uvs);
        EXPECT_EQ(*uvs, mesh.uvs);
        EXPECT_EQ(uvs_of(*read), uvs);
        EXPECT_EQ(aside.bytes_aside(), 0u);
        EXPECT_EQ(aside.memory_bytes(), mesh.memory_bytes());
    }
    EXPECT_GT(aside.bytes_aside(), 0u) << "nobody holds them any more";
    EXPECT_EQ(*uvs_of(*read), mesh.uvs) << "a second time";

    ASSERT_TRUE(write_mesh(folder.path / "b.ply", aside));
    ASSERT_TRUE(write_mesh(folder.path / "a.ply", mesh));
    EXPECT_EQ(testing::slurp(folder.path / "b.ply"), testing::slurp(folder.path / "a.ply"));

    mesh.positions.pop_back();
    mesh.uvs.pop_back();
    mesh.triangles[0].z = 2;
    ASSERT_TRUE(write_mesh(folder.path / "c.ply", mesh));
    EXPECT_EQ((*read_mesh(folder.path / "c.ply"))->uvs, mesh.uvs) << "a file costs more than few would save";
}

TEST(ReadMesh, TakesNoMoreMemoryThanItHolds) {
    const TempFolder folder;
    const TriangleMesh mesh = random_mesh();
    for (const char* name : {"a.ply", "a.obj"}) {
        ASSERT_TRUE(write_mesh(folder.path / name, mesh));
        const auto read = read_mesh(folder.path / name);
        ASSERT_TRUE(read) << error_of(read);
        const TriangleMesh& m = **read;
        const std::uint64_t reserved = m.positions.capacity() * sizeof(Vec3) + m.normals.capacity() * sizeof(Vec3) +
                                       m.uvs.capacity() * sizeof(Vec2) + m.triangles.capacity() * sizeof(glm::uvec3);
        EXPECT_EQ(m.memory_bytes(), reserved) << name;
    }
}

TEST(ReadMesh, UnknownAndMissingFiles) {
    EXPECT_THAT(error_of(read_mesh("a.stl")), HasSubstr("unknown mesh extension '.stl'"));
    EXPECT_THAT(error_of(read_mesh("/no/such/a.obj")), HasSubstr("/no/such/a.obj: no such file"));
    EXPECT_TRUE(is_mesh_file("a.OBJ"));
    EXPECT_FALSE(is_mesh_file("a.glb"));
}

}  // namespace
}  // namespace rayuela
