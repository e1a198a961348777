#include "assets/generators/mesh_file.h"
#include "core/math/vec.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

/// The scenes that are too regular, or too random, to write by hand. Each function returns the text of one scene file.
namespace rayuela::assets {
namespace {

/// PCG32 (O'Neill 2014): the same numbers everywhere.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) { next(); }

    /// In [0, 1).
    double uniform() { return next() * 0x1p-32; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    std::size_t index(std::size_t count) { return static_cast<std::size_t>(uniform() * static_cast<double>(count)); }

private:
    std::uint32_t next() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005u + 1442695040888963407u;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
        const auto turn = static_cast<std::uint32_t>(old >> 59);
        return (shifted >> turn) | (shifted << ((32 - turn) & 31));
    }

    std::uint64_t state_;
};

/// A number with at most four decimals, so that the last bit of a libm does not show.
std::string number(double value) {
    const double rounded = std::round(value * 1e4) / 1e4;
    return fmt::format("{}", rounded == 0 ? 0 : rounded);
}

std::string vector(const Vec3d& v) {
    return fmt::format("[{}, {}, {}]", number(v.x), number(v.y), number(v.z));
}

std::string sphere_object(const Vec3d& center, double radius, const std::string& material,
                          const std::string& name = "") {
    return fmt::format(R"({{"type": "sphere", {}"center": {}, "radius": {}, "material": "{}"}})",
                       name.empty() ? "" : fmt::format("\"name\": \"{}\", ", name), vector(center), number(radius),
                       material);
}

std::string join(const std::vector<std::string>& lines, const std::string& indent = "    ") {
    return fmt::format("{}{}", indent, fmt::join(lines, ",\n" + indent));
}

std::string metal(const std::string& name, const Vec3d& albedo, double roughness) {
    return fmt::format(R"("{}": {{"type": "metal", "albedo": {}, "roughness": {}}})", name, vector(albedo),
                       number(roughness));
}

std::string diffuse(const std::string& name, const Vec3d& albedo) {
    return fmt::format(R"("{}": {{"type": "diffuse", "albedo": {}}})", name, vector(albedo));
}

std::string emitter(const std::string& name, const Vec3d& radiance) {
    return fmt::format(R"("{}": {{"type": "emitter", "radiance": {}}})", name, vector(radiance));
}

/// The last image of "Ray Tracing in One Weekend" (Shirley, Black, Hollasch), with our own dice and palette.
std::string weekend() {
    constexpr double kGround = 1000, kSmall = 0.2;
    const std::vector<Vec3d> paints = {{0.55, 0.07, 0.06}, {0.72, 0.26, 0.05}, {0.75, 0.5, 0.07},  {0.3, 0.42, 0.08},
                                       {0.08, 0.3, 0.16},  {0.07, 0.35, 0.38}, {0.06, 0.16, 0.42}, {0.2, 0.1, 0.36},
                                       {0.5, 0.12, 0.28},  {0.62, 0.58, 0.5},  {0.22, 0.13, 0.08}, {0.12, 0.13, 0.15}};
    const std::vector<Vec3d> metals = {{0.9, 0.88, 0.85}, {0.9, 0.7, 0.36}, {0.85, 0.5, 0.36}, {0.6, 0.68, 0.75}};
    std::vector<std::string> materials = {diffuse("ground", {0.5, 0.5, 0.5}),
                                          R"("glass": {"type": "dielectric", "ior": 1.5})",
                                          diffuse("brown", {0.4, 0.2, 0.1}), metal("mirror", {0.7, 0.6, 0.5}, 0)};
    for (std::size_t i = 0; i < paints.size(); ++i)
        materials.push_back(diffuse(fmt::format("paint {}", i + 1), paints[i]));
    for (std::size_t i = 0; i < metals.size(); ++i) {
        materials.push_back(metal(fmt::format("metal {}", i + 1), metals[i], 0.1 + 0.15 * static_cast<double>(i)));
    }
    std::vector<std::string> objects = {sphere_object({0, -kGround, 0}, kGround, "ground", "ground"),
                                        sphere_object({0, 1, 0}, 1, "glass", "glass ball"),
                                        sphere_object({-4, 1, 0}, 1, "brown", "brown ball"),
                                        sphere_object({4, 1, 0}, 1, "mirror", "metal ball")};
    std::vector<Vec3d> placed;
    const auto is_free = [&](const Vec3d& p) {
        for (const Vec3d& q : placed) {
            if (glm::distance(p, q) < 2 * kSmall) return false;
        }
        return glm::distance(p, {4, kSmall, 0}) > 0.95 && glm::distance(p, {0, kSmall, 0}) > 0.95 &&
               glm::distance(p, {-4, kSmall, 0}) > 0.95;
    };
    Random random(1996);
    for (int a = -11; a < 11; ++a) {
        for (int b = -11; b < 11; ++b) {
            Vec3d p(0);
            int tries = 0;
            do {
                p.x = a + 0.9 * random.uniform();
                p.z = b + 0.9 * random.uniform();
                p.y = std::sqrt((kGround + kSmall) * (kGround + kSmall) - p.x * p.x - p.z * p.z) - kGround;
            } while (!is_free(p) && ++tries < 50);
            if (tries == 50) continue;
            placed.push_back(p);
            const double kind = random.uniform();
            const std::string material = kind < 0.75   ? fmt::format("paint {}", random.index(paints.size()) + 1)
                                         : kind < 0.92 ? fmt::format("metal {}", random.index(metals.size()) + 1)
                                                       : "glass";
            objects.push_back(sphere_object(p, kSmall, material));
        }
    }
    return fmt::format(R"(// One Weekend: {} spheres on a big one, seen through a lens of finite size.
// Written by assets/generators/scenes.cpp.
{{
  "rayuela": 1,
  "film": {{"width": 960, "height": 540}},
  "camera": {{"position": [13, 2, 3], "target": [0, 0, 0], "vfov": 20, "lens_radius": 0.05, "focus_distance": 10}},
  "environment": {{"type": "gradient", "bottom": [1, 1, 1], "top": [0.5, 0.7, 1]}},
  "materials": {{
{}
  }},
  "objects": [
{}
  ]
}}
)",
                       objects.size() - 1, join(materials), join(objects));
}

/// The set-up of Veach's thesis (1997, figure 9.2): neither sampling the lamps nor sampling the plates is right everywhere.
std::string veach() {
    const Vec3d eye(0, 3.4, 11), lamps(0, 3.6, -3.2);
    const std::array<double, 4> radii = {0.05, 0.15, 0.38, 0.82}, columns = {-4.1, -1.8, 0.9, 3.6};
    const std::array<Vec3d, 4> colors = {{{1, 0.35, 0.2}, {1, 0.8, 0.3}, {0.35, 0.9, 0.6}, {0.35, 0.55, 1}}};
    const std::array<double, 4> roughness = {0.06, 0.16, 0.28, 0.42};
    std::vector<std::string> materials = {diffuse("room", {0.42, 0.41, 0.4})}, objects;
    objects.push_back(
        R"({"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "room"})");
    objects.push_back(
        R"({"type": "plane", "name": "wall", "point": [0, 0, -5.5], "normal": [0, 0, 1], "material": "room"})");
    for (std::size_t i = 0; i < 4; ++i) {
        materials.push_back(metal(fmt::format("plate {}", i + 1), {0.72, 0.72, 0.74}, roughness[i]));
        const double step = static_cast<double>(i);
        const Vec3d center(0, 1.62 - 0.42 * step, -2.2 + 1.45 * step);
        // The plate's normal halves the angle between eye and lamps, so that each plate mirrors the whole row.
        const Vec3d normal = glm::normalize(glm::normalize(eye - center) + glm::normalize(lamps - center));
        objects.push_back(fmt::format(
            R"({{"type": "box", "name": "plate {0}", "min": [-3.9, -0.06, -0.7], "max": [3.9, 0, 0.7], "material": "plate {0}",)"
            R"( "transform": {{"translate": {1}, "rotate": {{"axis": [1, 0, 0], "degrees": {2}}}}}}})",
            i + 1, vector(center), number(glm::degrees(std::atan2(normal.z, normal.y)))));
    }
    for (std::size_t i = 0; i < 4; ++i) {
        materials.push_back(emitter(fmt::format("lamp {}", i + 1), colors[i] * (1.3 / (radii[i] * radii[i]))));
        objects.push_back(sphere_object({columns[i], lamps.y, lamps.z}, radii[i], fmt::format("lamp {}", i + 1),
                                        fmt::format("lamp {}", i + 1)));
    }
    return fmt::format(R"(// Veach's plates: four lamps of equal power mirrored in plates from polished to dull.
// Written by assets/generators/scenes.cpp.
{{
  "rayuela": 1,
  "film": {{"width": 900, "height": 600}},
  "camera": {{"position": {}, "target": [0, 1.95, 0], "vfov": 31, "focus_distance": 11}},
  "materials": {{
{}
  }},
  "objects": [
{}
  ]
}}
)",
                       vector(eye), join(materials), join(objects));
}

/// Strings of bulbs under the ceiling of a hall.
std::string many_lights() {
    constexpr int kStrings = 9, kBulbs = 36;
    const std::vector<Vec3d> colors = {{17, 11, 5}, {18, 13, 7}, {18, 6, 3}, {5, 12, 18}, {8, 16, 8}};
    std::vector<std::string> materials = {
        diffuse("wall", {0.62, 0.6, 0.57}),
        diffuse("left wall", {0.45, 0.2, 0.14}),
        diffuse("right wall", {0.12, 0.26, 0.34}),
        R"("floor": {"type": "principled", "base_color": [0.2, 0.16, 0.13], "roughness": 0.25})",
        metal("steel", {0.8, 0.8, 0.82}, 0.3),
        metal("gold", {0.9, 0.68, 0.35}, 0.45),
        diffuse("plaster", {0.72, 0.7, 0.66}),
        R"("yellow": {"type": "principled", "base_color": [0.95, 0.62, 0.04], "roughness": 0.35})",
        R"("orange": {"type": "principled", "base_color": [0.9, 0.2, 0.02], "roughness": 0.35})",
        R"("eye": {"type": "principled", "base_color": [0.01, 0.01, 0.012], "roughness": 0.08})"};
    for (std::size_t i = 0; i < colors.size(); ++i)
        materials.push_back(emitter(fmt::format("bulb {}", i + 1), colors[i]));
    std::vector<std::string> objects = {
        R"({"type": "quad", "name": "floor", "point": [-4, 0, 5], "u": [8, 0, 0], "v": [0, 0, -10], "material": "floor"})",
        R"({"type": "quad", "name": "ceiling", "point": [-4, 4, -5], "u": [8, 0, 0], "v": [0, 0, 10], "material": "wall"})",
        R"({"type": "quad", "name": "back wall", "point": [-4, 0, -5], "u": [8, 0, 0], "v": [0, 4, 0], "material": "wall"})",
        R"({"type": "quad", "name": "front wall", "point": [4, 0, 5], "u": [-8, 0, 0], "v": [0, 4, 0], "material": "wall"})",
        R"({"type": "quad", "name": "left wall", "point": [-4, 0, 5], "u": [0, 0, -10], "v": [0, 4, 0], "material": "left wall"})",
        R"({"type": "quad", "name": "right wall", "point": [4, 0, -5], "u": [0, 0, 10], "v": [0, 4, 0], "material": "right wall"})",
        R"({"type": "box", "name": "table", "min": [-1.1, 0, -0.8], "max": [1.1, 0.7, 0.8], "material": "plaster",)"
        R"( "transform": {"translate": [0.2, 0, -0.6], "rotate": {"axis": [0, 1, 0], "degrees": 14}}})",
        R"({"type": "list", "name": "duck", "transform": {"translate": [0.1, 0.7, -0.55], "scale": 0.95}, "objects": [
      {"type": "mesh", "name": "body", "file": "../meshes/duck_body.obj", "material": "yellow"},
      {"type": "mesh", "name": "bill", "file": "../meshes/duck_bill.obj", "material": "orange"},
      {"type": "sphere", "name": "left eye", "center": [0.155, 1.1, 0.585], "radius": 0.06, "material": "eye"},
      {"type": "sphere", "name": "right eye", "center": [-0.155, 1.1, 0.585], "radius": 0.06, "material": "eye"}
    ]})",
        sphere_object({-2.2, 0.75, -1.8}, 0.75, "steel", "steel ball"),
        sphere_object({2.5, 0.55, 0.3}, 0.55, "gold", "golden ball"),
        R"({"type": "box", "name": "pillar", "min": [2.1, 0, -3.4], "max": [2.8, 4, -2.7], "material": "plaster"})",
        R"({"type": "box", "name": "pillar", "min": [-3.2, 0, -4.1], "max": [-2.5, 4, -3.4], "material": "plaster"})"};
    Random random(1001);
    for (int string = 0; string < kStrings; ++string) {
        const double z = -4.4 + 0.95 * string, sag = random.uniform(0.35, 0.85), skew = random.uniform(-0.5, 0.5);
        for (int bulb = 0; bulb < kBulbs; ++bulb) {
            const double t = (bulb + 0.5) / kBulbs * 2 - 1;
            const Vec3d center(3.9 * t, 3.85 - sag * (1 - t * t), z + skew * t);
            objects.push_back(sphere_object(center, 0.035, fmt::format("bulb {}", random.index(colors.size()) + 1)));
        }
    }
    return fmt::format(R"(// Many lights: a hall lit by {} coloured bulbs on strings.
// Written by assets/generators/scenes.cpp.
{{
  "rayuela": 1,
  "film": {{"width": 800, "height": 600}},
  "camera": {{"position": [0.9, 1.9, 4.7], "target": [0, 1.55, -1], "vfov": 50, "focus_distance": 5.4}},
  "materials": {{
{}
  }},
  "objects": [
{}
  ]
}}
)",
                       kStrings * kBulbs, join(materials), join(objects));
}

int write_scenes(const std::filesystem::path& folder) {
    for (const auto& [name, text] :
         {std::pair{"weekend", weekend()}, {"veach", veach()}, {"many_lights", many_lights()}}) {
        const std::filesystem::path path = folder / fmt::format("{}.scene.json", name);
        if (!write_file(path, text)) {
            fmt::print(stderr, "{}: cannot be written\n", path.string());
            return 1;
        }
        fmt::print("{}\n", path.string());
    }
    return 0;
}

}  // namespace
}  // namespace rayuela::assets

/// gen_scenes FOLDER: writes weekend, veach and many_lights.
int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "usage: {} FOLDER\n", argv[0]);
        return 2;
    }
    return rayuela::assets::write_scenes(argv[1]);
}
