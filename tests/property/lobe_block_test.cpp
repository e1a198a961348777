#include "tests/render_testing.h"

#include <gtest/gtest.h>

// Surfaces shaded many at once and one by one: two programs for the same thing, and every bit must agree.

namespace rayuela {
namespace {

using namespace rayuela::testing;

struct Case {
    const char* name;
    void (*light)(Scene& scene, MaterialId lamp);
};

const Case kCases[] = {
    {"sky alone",
     [](Scene& scene, MaterialId) {
         scene.environment = GradientEnvironment{Color(0.3f), Color(1)};
     }},
    {"quad lamp",
     [](Scene& scene, MaterialId lamp) {
         add_object(scene, Quad{Vec3(-1, 4, 1), Vec3(2, 0, 0), Vec3(0, 0, 1)}, lamp);
     }},
    {"two-sided quad lamp among the things",
     [](Scene& scene, MaterialId) {
         const MaterialId both = add_material(scene, Emitter{{Color(6, 7, 8), nullptr}, true});
         add_object(scene, Quad{Vec3(-0.5f, 1.2f, 1.4f), Vec3(1, 0, 0.2f), Vec3(0, 0.3f, 0.9f)}, both);
     }},
    {"triangle lamp and sky",
     [](Scene& scene, MaterialId lamp) {
         scene.environment = ConstantEnvironment{Color(0.2f)};
         add_object(scene, Triangle{{Vec3(-2, 3, -1), Vec3(0, 3, 1), Vec3(2, 3.5f, -1)}}, lamp);
     }},
    {"caustics of a small lamp",
     [](Scene& scene, MaterialId lamp) {
         add_object(scene, Sphere{Vec3(-1, 2.6f, 2), 0.1f}, lamp);
         add_object(scene, Sphere{Vec3(0.2f, 0.5f, 1.6f), 0.5f}, add_material(scene, Dielectric{}));
         add_object(scene, Sphere{Vec3(1.6f, 0.5f, 1.8f), 0.5f}, add_material(scene, Metal{}));
     }},
    {"sphere lamp",
     [](Scene& scene, MaterialId lamp) {
         add_object(scene, Sphere{Vec3(0.5f, 2.2f, 0.5f), 0.5f}, lamp);
     }},
    {"few lamps of all kinds, one two-sided and one around everything",
     [](Scene& scene, MaterialId lamp) {
         const MaterialId both = add_material(scene, Emitter{{Color(2, 3, 1), nullptr}, true});
         add_object(scene, Quad{Vec3(-3, 3, 1), Vec3(0.5f, 0, 0), Vec3(0, 0, 0.5f)}, both);
         add_object(scene, Triangle{{Vec3(-2, 3, -1), Vec3(0, 3, 1), Vec3(2, 3.5f, -1)}}, lamp);
         add_object(scene, Sphere{Vec3(1.5f, 2, 2), 0.2f}, lamp);
         add_object(scene, Sphere{Vec3(-2.5f, 1, 0), 0.05f}, both);
         add_object(scene, Sphere{Vec3(0, 1, 0), 30}, add_material(scene, Emitter{{Color(0.1f), nullptr}, true}));
     }},
    {"many lamps",
     [](Scene& scene, MaterialId lamp) {
         for (int i = 0; i < 6; ++i) {
             const auto x = static_cast<float>(i);
             add_object(scene, Quad{Vec3(x - 3, 3, 1), Vec3(0.5f, 0, 0), Vec3(0, 0, 0.5f)}, lamp);
             add_object(scene, Sphere{Vec3(3 - x, 2, 2), 0.2f}, lamp);
         }
     }},
};

/// Materials of several lobes.
void add_layered(Scene& scene, const std::shared_ptr<const Image>& stripes) {
    const auto add_ball = [&](const Vec3& center, const Material& material) {
        add_object(scene, Sphere{center, 0.3f}, add_material(scene, material));
    };
    const ColorValue color{Color(0.9f, 0.6f, 0.3f), nullptr};
    Principled coated{.base_color = color, .metallic = {0.6f, nullptr, 2}, .roughness = {0.4f, nullptr, 1}};
    coated.clearcoat = 0.7f;
    coated.clearcoat_roughness = 0.2f;
    Principled polished = coated;
    polished.clearcoat_roughness = 0;
    Principled glowing = coated;
    glowing.emissive = {Color(0.1f), nullptr};
    add_ball(Vec3(-2.2f, 0.3f, 1.2f), coated);
    add_ball(Vec3(-2.2f, 0.9f, 1.2f), polished);
    add_ball(Vec3(-2.2f, 1.5f, 1.2f), glowing);
    add_ball(Vec3(-1.5f, 0.9f, 1.4f), Principled{.base_color = color});
    add_ball(Vec3(0.3f, 0.3f, 1.5f), Principled{.base_color = color, .transmission = {0.8f, nullptr, 0}});
    add_ball(Vec3(0.3f, 0.9f, 1.5f), Principled{.base_color = {Color(1), stripes}, .roughness = {1, stripes, 0}});
    add_ball(Vec3(1.2f, 0.3f, 1.6f), Principled{.base_color = color, .transmission = {1, stripes, 0}});
    add_ball(Vec3(1.2f, 0.9f, 1.6f), Metal{color, {0.8f, nullptr, 0}, true});
    add_ball(Vec3(2, 0.3f, 1.5f), Metal{color, {1, stripes, 0}, true});
    add_ball(Vec3(2, 0.9f, 1.5f), Dielectric{1.5f, color, {0.3f, nullptr, 0}});
    add_ball(Vec3(2, 1.5f, 1.5f), Dielectric{0.8f, color, {1, stripes, 0}});
}

Scene plain_scene(const Case& lit, SamplerKind sampler) {
    Scene scene = empty_scene(45, 31);  // Blocks that are not full.
    scene.camera.position = Vec3(0, 2.5f, 7);
    scene.camera.target = Vec3(0, 0.8f, 0);
    scene.environment = ConstantEnvironment{Color(0)};
    scene.render.max_bounces = 12;
    scene.render.sampler = sampler;
    const MaterialId clay = add_material(scene, Diffuse{{Color(0.7f, 0.45f, 0.3f), nullptr}});
    const MaterialId dark = add_material(scene, Diffuse{{Color(0.05f, 0.2f, 0), nullptr}});
    const MaterialId black = add_material(scene, Diffuse{{Color(0), nullptr}});
    const MaterialId gold = add_material(scene, Metal{{Color(0.9f, 0.75f, 0.45f), nullptr}, {0.3f, nullptr, 0}});
    const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(8, 7, 6), nullptr}});
    add_object(scene, Plane{}, clay);
    add_object(scene, Sphere{Vec3(-1.8f, 0.8f, 0), 0.8f}, dark);
    add_object(scene, Box{Vec3(1, 0, -0.5f), Vec3(2, 1.2f, 0.5f)}, gold);
    add_object(scene, Triangle{{Vec3(-3, 0, -2), Vec3(3, 0, -2), Vec3(0, 3, -2.2f)}}, black);
    Transform raised;
    raised.translate = Vec3(0, 0.5f, -0.6f);
    add_object(scene, Mesh{"torus", torus_mesh(10, 6)}, clay, raised);
    add_object(scene, Sphere{Vec3(-0.4f, 0.35f, 2.2f), 0.35f},
               add_material(scene, Dielectric{1.5f, {Color(0.9f, 1, 0.95f), nullptr}}));
    add_object(scene, Sphere{Vec3(-0.4f, 0.35f, 2.2f), 0.3f}, add_material(scene, Dielectric{0.7f}));
    add_object(scene, Sphere{Vec3(-1.3f, 0.3f, 2), 0.3f}, add_material(scene, Metal{{Color(0.8f), nullptr}}));
    add_object(scene, Sphere{Vec3(0.8f, 0.3f, 2.4f), 0.3f},
               add_material(scene, Metal{{Color(0), nullptr}, {0.5f, nullptr, 0}}));
    const auto stripes = std::make_shared<const Image>(Image{2, 1, {Vec4(0), Vec4(0.9f)}, "stripes"});
    add_object(scene, Quad{Vec3(-3, 0, -1), Vec3(0, 2, 0), Vec3(1, 0, -1)},
               add_material(scene, Diffuse{{Color(1), stripes}}));
    add_object(scene, Quad{Vec3(3, 0, -1), Vec3(0, 2, 0), Vec3(-1, 0, -1)},
               add_material(scene, Metal{{Color(1), nullptr}, {1, stripes, 0}}));
    add_layered(scene, stripes);
    lit.light(scene, lamp);
    return scene;
}

class LobeBlocks : public ::testing::TestWithParam<Case> {};

TEST_P(LobeBlocks, GiveTheBitsOfSinglePaths) {
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
        const Scene scene = plain_scene(GetParam(), sampler);
        for (const bool mis : {true, false}) {
            const auto blocks = render(scene, 5, {.mis = mis});
            const auto singles = render(scene, 5, {.mis = mis, .shortcuts = {.lobe_blocks = false}});
            EXPECT_EQ(means(blocks->film()), means(singles->film()));
            EXPECT_GT(estimate(blocks->film()).mean, 0.01);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, LobeBlocks, ::testing::ValuesIn(kCases), [](const auto& test) {
    std::string name;
    for (const char c : std::string(test.param.name)) name += std::isalnum(c) ? c : '_';
    return name;
});

}  // namespace
}  // namespace rayuela
