#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <cmath>

// With paths from the lamps the expected image is the one that camera paths alone would find.

namespace rayuela {
namespace {

using namespace rayuela::testing;

struct Case {
    const char* name;
    void (*set_up)(Scene& scene, MaterialId glass, MaterialId mirror, MaterialId lamp);
};

void quad_lamp(Scene& scene, MaterialId lamp) {
    add_object(scene, Quad{Vec3(-0.6f, 3, -0.6f), Vec3(1.2f, 0, 0), Vec3(0, 0, 1.2f)}, lamp);
}

const Case kCases[] = {
    {"balls",
     [](Scene& scene, MaterialId glass, MaterialId mirror, MaterialId lamp) {
         quad_lamp(scene, lamp);
         add_object(scene, Sphere{Vec3(-0.8f, 0.7f, 0), 0.7f}, glass);
         add_object(scene, Sphere{Vec3(0.9f, 0.6f, 0.4f), 0.6f}, mirror);
     }},
    {"interpolated normals",
     [](Scene& scene, MaterialId glass, MaterialId mirror, MaterialId lamp) {
         quad_lamp(scene, lamp);
         Transform raised;
         raised.translate = Vec3(-0.8f, 0.6f, 0);
         raised.scale = Vec3(0.7f, 1, 0.7f);
         add_object(scene, Mesh{"torus", torus_mesh(8, 5)}, glass, raised);
         raised.translate = Vec3(0.9f, 0.6f, 0.4f);
         add_object(scene, Mesh{"torus", torus_mesh(8, 5)}, mirror, raised);
     }},
    {"through a lens, soft pixels",
     [](Scene& scene, MaterialId glass, MaterialId, MaterialId lamp) {
         scene.camera.lens_radius = 0.3f;
         scene.camera.focus_distance = 4;
         scene.film.filter = PixelFilter::gaussian;
         quad_lamp(scene, lamp);
         add_object(scene, Sphere{Vec3(0, 0.7f, 0), 0.7f}, glass);
     }},
    {"two-sided lamp between a mirror plane and a pane",
     [](Scene& scene, MaterialId glass, MaterialId mirror, MaterialId) {
         scene.film.filter = PixelFilter::tent;
         const MaterialId both = add_material(scene, Emitter{{Color(6, 7, 8), nullptr}, true});
         add_object(scene, Quad{Vec3(-0.5f, 1.2f, 0), Vec3(1, 0, 0.2f), Vec3(0, 0.3f, 0.9f)}, both);
         add_object(scene, Plane{Vec3(0, 0, -1.5f), Vec3(0, 0, 1)}, mirror);
         add_object(scene, Box{Vec3(-0.7f, 0.5f, 0.2f), Vec3(0.7f, 0.6f, 1.2f)}, glass);
     }},
    {"sphere lamp, coated and glossy things",
     [](Scene& scene, MaterialId, MaterialId, MaterialId lamp) {
         add_object(scene, Sphere{Vec3(0.5f, 2.2f, 0.5f), 0.5f}, lamp);
         Principled coated;
         coated.base_color.value = Color(0.8f, 0.3f, 0.2f);
         coated.clearcoat = 1;
         const MaterialId lacquer = add_material(scene, coated);
         const MaterialId polished =
             add_material(scene, Principled{.metallic = {1, nullptr, 2}, .roughness = {0, nullptr, 1}});
         const MaterialId frosted = add_material(scene, Dielectric{.roughness = {0.4f, nullptr, 0}});
         add_object(scene, Sphere{Vec3(-0.9f, 0.6f, 0), 0.6f}, lacquer);
         add_object(scene, Sphere{Vec3(0.9f, 0.5f, 0.3f), 0.5f}, polished);
         add_object(scene, Sphere{Vec3(0, 0.3f, 1), 0.3f}, frosted);
     }},
    {"lamp and camera under water",
     [](Scene& scene, MaterialId glass, MaterialId mirror, MaterialId lamp) {
         // The lamp is above the surface of a tank that holds floor, ball and camera.
         add_object(scene, Quad{Vec3(-0.6f, 3, -0.6f), Vec3(1.2f, 0, 0), Vec3(0, 0, 1.2f)}, lamp);
         add_object(scene, Box{Vec3(-6, -1, -6), Vec3(6, 2.5f, 6)}, glass);
         add_object(scene, Sphere{Vec3(0.2f, 0.6f, 0), 0.6f}, mirror);
     }},
};

Scene scene_of(const Case& test) {
    Scene scene = empty_scene(32, 24);
    scene.camera.position = Vec3(0.3f, 1.6f, 4);
    scene.camera.target = Vec3(0, 0.4f, 0);
    scene.camera.vfov = 50;
    scene.render.sampler = SamplerKind::independent;
    scene.render.max_bounces = 6;
    const MaterialId clay = add_material(scene, Diffuse{{Color(0.6f, 0.5f, 0.4f), nullptr}});
    const MaterialId glass = add_material(scene, Dielectric{});
    const MaterialId mirror = add_material(scene, Metal{});
    const MaterialId lamp = add_material(scene, Emitter{{Color(8, 7, 6), nullptr}});
    add_object(scene, Plane{}, clay);
    add_object(scene, Quad{Vec3(-2, 0, -2), Vec3(4, 0, 0), Vec3(0, 4, 0)}, clay);
    test.set_up(scene, glass, mirror, lamp);
    return scene;
}

/// Of the whole images and of vertical bands of them, as far as chance allows.
void expect_equal_means(const Film& left, const Film& right) {
    constexpr int kBands = 8;
    for (int band = -1; band < kBands; ++band) {
        const double from = band < 0 ? 0 : band / double{kBands}, to = band < 0 ? 1 : (band + 1) / double{kBands};
        const Estimate a = estimate(left, from, to), b = estimate(right, from, to);
        EXPECT_LT(std::abs(a.mean - b.mean) / std::sqrt(a.variance + b.variance), 5)
            << "band " << band << ": " << a.mean << " and " << b.mean;
    }
}

class Caustics : public ::testing::TestWithParam<Case> {};

TEST_P(Caustics, LampPathsDoNotChangeTheExpectedImage) {
    Scene scene = scene_of(GetParam());
    ASSERT_TRUE(make_render_scene(scene)->emission());
    const auto with = render(scene, 300);
    scene.render.seed = 1;
    const auto without = render(scene, 600, {.light_tracing = false});
    EXPECT_EQ(with->film().rejected(), (std::array<std::uint64_t, kRejectionCount>{}));
    EXPECT_GT(with->film().rounds(), 0u);
    EXPECT_EQ(without->film().rounds(), 0u);
    expect_equal_means(with->film(), without->film());
}

/// Of dark things, so that paths are cut at every bounce from the first.
TEST_P(Caustics, RouletteDoesNotChangeTheExpectedImage) {
    Scene scene = scene_of(GetParam());
    std::get<Diffuse>(scene.materials[0].material).albedo.value = Color(0.05f, 0.1f, 0.2f);
    scene.render.rr_start = 1;
    const auto with = render(scene, 300);
    scene.render.seed = 1;
    const auto without = render(scene, 300, {.russian_roulette = false});
    expect_equal_means(with->film(), without->film());
}

TEST_P(Caustics, ThreadsAndPassesDoNotChangeTheImage) {
    const Scene scene = scene_of(GetParam());
    const auto expected = means(render(scene, 3)->film());
    EXPECT_EQ(means(render(scene, 3, {}, 4)->film()), expected);
    Passes passes(scene);
    for (const int samples : {1, 2, 3}) passes.render_to(samples);
    EXPECT_EQ(means(passes.film().film()), expected);
    passes.film().restart();
    passes.render_to(3);
    EXPECT_EQ(means(passes.film().film()), expected);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Caustics, ::testing::ValuesIn(kCases), [](const auto& test) {
    std::string name = test.param.name;
    std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
    return name;
});

TEST(CausticNoise, OfASmallLampIsFarLess) {
    // The camera sees nothing but the floor, where a glass ball out of view gathers the light of a small lamp.
    Scene scene = empty_scene(16, 16);
    scene.camera.position = Vec3(0, 0.6f, 2.5f);
    scene.camera.target = Vec3(0);
    scene.camera.vfov = 15;
    add_object(scene, Plane{});
    add_object(scene, Sphere{Vec3(0, 1.2f, 0), 0.5f}, add_material(scene, Dielectric{}));
    add_object(scene, Quad{Vec3(-0.1f, 3, -0.1f), Vec3(0.2f, 0, 0), Vec3(0, 0, 0.2f)},
               add_material(scene, Emitter{{Color(200), nullptr}}));
    const auto image = [&](int samples, std::uint32_t seed, bool light_tracing) {
        scene.render.seed = seed;
        return means(render(scene, samples, {.light_tracing = light_tracing})->film());
    };
    // Without, a few samples hold most of the error: many seeds.
    constexpr std::uint32_t kSeeds = 20;
    const std::vector<Vec3d> truth = image(1000, kSeeds, true);
    double error_with = 0, error_without = 0;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
        const std::vector<Vec3d> with = image(16, seed, true), without = image(16, seed, false);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const Vec3d scale = 1.0 / (truth[i] * truth[i] + 0.01);
            error_with += glm::dot((with[i] - truth[i]) * (with[i] - truth[i]), scale);
            error_without += glm::dot((without[i] - truth[i]) * (without[i] - truth[i]), scale);
        }
    }
    EXPECT_LT(error_with, 0.02 * error_without);
}

TEST(CausticCost, LittleIsSpentOnLargeLamps) {
    Scene scene = scene_of(kCases[0]);
    const auto lamp_paths = [&] {
        const auto render_scene = make_render_scene(scene);
        return PathTracer(*render_scene, 100, 100).light_tracer()->paths();
    };
    EXPECT_EQ(lamp_paths(), 2500u);
    for (Object& object : scene.objects) {
        if (auto* quad = std::get_if<Quad>(&object.shape); quad && quad->point.y == 3) {
            *quad = {Vec3(-2, 3, -2), Vec3(4, 0, 0), Vec3(0, 0, 4)};
        }
    }
    EXPECT_EQ(lamp_paths(), 625u);
}

TEST(CausticCost, NoLampPathsWithoutMirrorOrLamp) {
    Scene scene = empty_scene(8, 8);
    scene.environment = ConstantEnvironment{};
    const MaterialId lamp = add_material(scene, Emitter{});
    const MaterialId mirror = add_material(scene, Metal{});
    add_object(scene, Plane{});
    const ObjectId ball = add_object(scene, Sphere{Vec3(0, 2, 0), 0.5f}, lamp);
    EXPECT_FALSE(make_render_scene(scene)->emission()) << "no mirror";
    add_object(scene, Sphere{Vec3(2, 1, 0), 0.5f}, mirror);
    EXPECT_TRUE(make_render_scene(scene)->emission());
    std::erase_if(scene.objects, [&](const Object& object) { return object.id == ball; });
    EXPECT_FALSE(make_render_scene(scene)->emission()) << "no lamp";
    EXPECT_EQ(render(scene, 1)->film().rounds(), 0u);
}

}  // namespace
}  // namespace rayuela
