#include "tests/stress/paths.h"
#include "tests/support/closed_meshes.h"

#include <fmt/format.h>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;
using namespace rayuela::testing;

const Material kWhite = Diffuse{{Color(1), nullptr}};

/// Light that a path has no business to find is its figure.
Outcome expect_dark(const Scene& scene, std::uint64_t paths, const std::string& name) {
    return trace_paths(
        scene, paths, {.russian_roulette = false}, [&](const PathId& id, const Color& radiance, Outcome& outcome) {
            outcome.measure(max_component(glm::abs(radiance)) + 0 * luminance(radiance));
            outcome.expect(is_black(radiance),
                           [&] { return fmt::format("{}: pixel {} sample {}", name, id.pixel, id.sample); });
        });
}

/// A camera in the middle of `center` within a bright world and a lamp around everything.
Scene bright_world(const Vec3& center) {
    Scene scene = empty_scene(64, 64);
    scene.camera.position = center;
    scene.camera.target = center + Vec3(0.3f, -0.2f, 1);
    scene.camera.vfov = 120;
    scene.environment = ConstantEnvironment{Color(1)};
    scene.render.max_bounces = 50;
    add_object(scene, Sphere{center, 30}, add_material(scene, Emitter{{Color(10), nullptr}, true}));
    return scene;
}

struct Room {
    const char* name;
    void (*add_walls)(Scene&, const Vec3& center, MaterialId wall);
};

void add_box(Scene& scene, const Vec3& center, MaterialId wall) {
    add_object(scene, Box{center - 2.0f, center + 2.0f}, wall);
}
void add_quads(Scene& scene, const Vec3& center, MaterialId wall) {
    const Vec3 lo = center - 2.0f, hi = center + 2.0f;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 u(0), v(0);
        u[(axis + 1) % 3] = 4;
        v[(axis + 2) % 3] = 4;
        add_object(scene, Quad{lo, u, v}, wall);
        add_object(scene, Quad{hi, -u, -v}, wall);
    }
}
void add_turned_box(Scene& scene, const Vec3& center, MaterialId wall) {
    Transform turned;
    turned.translate = center;
    turned.rotate = glm::angleAxis(0.7f, glm::normalize(Vec3(1, 2, 3)));
    turned.scale = Vec3(2, 3, 2.5f);
    add_object(scene, Box{Vec3(-1), Vec3(1)}, wall, turned);
}
void add_mesh(Scene& scene, const Vec3& center, MaterialId wall) {
    Transform placed;
    placed.translate = center;
    placed.scale = Vec3(2.1f);
    add_object(scene, Mesh{"ball", make_ball(12, 1, Vec3(0), 0.15f, 5)}, wall, placed);
}
void add_sphere(Scene& scene, const Vec3& center, MaterialId wall) {
    add_object(scene, Sphere{center, 2}, wall);
}

Outcome rooms_are_dark(const std::vector<Room>& rooms, const Vec3& center, std::uint64_t rays) {
    const Material walls[] = {kWhite, Metal{{Color(1), nullptr}, {0.3f, nullptr, 0}},
                              Metal{{Color(1), nullptr}, {0, nullptr, 0}}};
    constexpr std::uint64_t kRaysPerPath = 60;
    Outcome total;
    for (const Room& room : rooms) {
        for (const Material& wall : walls) {
            Scene scene = bright_world(center);
            room.add_walls(scene, center, add_material(scene, wall));
            total.add(expect_dark(scene, rays / (rooms.size() * std::size(walls) * kRaysPerPath) + 1,
                                  fmt::format("{} at {} wall {}", room.name, describe(center), wall.index())));
        }
    }
    return total;
}

Outcome sealed_rooms(double scale) {
    const std::vector<Room> rooms{{"box", add_box},
                                  {"quads", add_quads},
                                  {"sphere", add_sphere},
                                  {"turned box", add_turned_box},
                                  {"mesh", add_mesh}};
    Outcome outcome = rooms_are_dark(rooms, Vec3(0), scaled(5e8, scale));
    outcome.add(rooms_are_dark(rooms, Vec3(1000.3f, -20.7f, 512.1f), scaled(5e8, scale)));
    return outcome;
}

/// Nothing shines but from below the floor, on which everything stands.
Outcome below_the_floor(double scale) {
    const Material bodies[] = {Dielectric{}, Dielectric{.roughness = {0.3f, nullptr, 0}}, kWhite};
    Outcome total;
    for (const Material& body : bodies) {
        for (const bool floor_first : {true, false}) {
            Scene scene = empty_scene(128, 64);
            scene.camera.position = Vec3(0, 1.5f, 5);
            scene.camera.target = Vec3(0, 0.5f, 0);
            scene.render.max_bounces = 20;
            const MaterialId material = add_material(scene, body), ground = add_material(scene, kWhite);
            const auto add_floor = [&] { add_object(scene, Plane{}, ground); };
            if (floor_first) add_floor();
            add_object(scene, Sphere{Vec3(-1.3f, 0.7f, 0), 0.7f}, material);
            add_object(scene, Sphere{Vec3(0, 0.4f, 1.7f), 0.4f}, material);
            add_object(scene, Box{Vec3(0.3f, 0, -0.5f), Vec3(1.7f, 1.1f, 0.6f)}, material);
            if (!floor_first) add_floor();
            add_object(scene, Quad{Vec3(-9, -1, 9), Vec3(18, 0, 0), Vec3(0, 0, -18)},
                       add_material(scene, Emitter{{Color(5), nullptr}, true}));
            total.add(expect_dark(scene, scaled(2e6, scale, 8192),
                                  fmt::format("body {} floor first {}", body.index(), floor_first)));
        }
    }
    return total;
}

/// A floor whose shading normals lean up to 89 degrees, over a lamp that it hides.
Outcome leaning_normals(double scale) {
    auto mesh = std::make_shared<TriangleMesh>(*make_grid(24, 0));
    Random random(33);
    for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
        mesh->positions[i] *= 10;
        const float lean = glm::radians(random.integer(0, 2) ? random.uniform(0, 89) : 89.0f),
                    turn = random.uniform(0, 2 * kPi);
        mesh->normals.push_back({std::sin(lean) * std::cos(turn), std::cos(lean), std::sin(lean) * std::sin(turn)});
    }
    const Material floors[] = {kWhite, Metal{{Color(1), nullptr}, {0.3f, nullptr, 0}, true}, Metal{}, Principled{},
                               Principled{.clearcoat = 1}};
    Outcome total;
    for (const Material& floor : floors) {
        Scene scene = empty_scene(128, 64);
        scene.camera.position = Vec3(0, 1.5f, 4);
        scene.camera.target = Vec3(0);
        add_object(scene, Mesh{"floor", mesh}, add_material(scene, floor));
        add_object(scene, Quad{Vec3(-3, -1, 3), Vec3(6, 0, 0), Vec3(0, 0, -6)},
                   add_material(scene, Emitter{{Color(5), nullptr}, true}));
        total.add(expect_dark(scene, scaled(4e6, scale, 8192), fmt::format("floor {}", floor.index())));
    }
    return total;
}

}  // namespace

std::vector<StressTest> light_leak_tests() {
    return {{29, "sealed rooms in a bright world are black", "radiance", 0, sealed_rooms},
            {30, "no ray passes below a floor that things stand on", "radiance", 0, below_the_floor},
            {33, "normals up to 89 degrees off: no light from below", "radiance", 0, leaning_normals}};
}

}  // namespace rayuela::stress
