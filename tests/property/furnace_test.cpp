#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <cmath>

// Scenes whose image is known in closed form.

namespace rayuela {
namespace {

using namespace rayuela::testing;

const PathTracerOptions kScatteringOnly{.light_sampling = false, .mis = false, .russian_roulette = false};

/// A camera at `position` that sees next to nothing but `target`.
void look_at(Scene& scene, const Vec3& position, const Vec3& target, float vfov = 0.01f) {
    scene.camera.position = position;
    scene.camera.target = target;
    scene.camera.up = Vec3(0.1f, 0.2f, 1);
    scene.camera.vfov = vfov;
}

void expect_mean(const Film& film, double expected, double sigmas = 4, double relative = 1e-5) {
    const Estimate got = estimate(film);
    EXPECT_NEAR(got.mean, expected, sigmas * std::sqrt(got.variance) + relative * expected);
}

struct WhiteMaterial {
    const char* name;
    Material material;
};

class Furnace : public ::testing::TestWithParam<WhiteMaterial> {};

/// Whatever loses no light vanishes in an environment that is the same everywhere.
TEST_P(Furnace, LosslessObjectsVanish) {
    Scene scene = empty_scene(64, 48);
    scene.environment = ConstantEnvironment{Color(1)};
    scene.render.max_bounces = 1000;
    const MaterialId material = add_material(scene, GetParam().material);
    add_object(scene, Sphere{Vec3(-1, 1, 0), 1}, material);
    add_object(scene, Box{Vec3(0.2f, 0, -0.5f), Vec3(1.5f, 1.5f, 0.7f)}, material);
    add_object(scene, Quad{Vec3(-2, 0, 2), Vec3(4, 0, 0), Vec3(0, 0, -4)}, material);
    const auto film = render(scene, 16);
    EXPECT_EQ(film->film().rejected(), (std::array<std::uint64_t, kRejectionCount>{}));
    for (const Vec3d& mean : means(film->film())) {
        for (int channel = 0; channel < 3; ++channel) ASSERT_NEAR(mean[channel], 1, 1e-4);
    }
}

const Dielectric kDiamond{.ior = 2.4f};
INSTANTIATE_TEST_SUITE_P(Materials, Furnace,
                         ::testing::Values(WhiteMaterial{"diffuse", Diffuse{{Color(1), nullptr}}},
                                           WhiteMaterial{"mirror", Metal{{Color(1), nullptr}, {0, nullptr, 0}}},
                                           WhiteMaterial{"glass", Dielectric{}}, WhiteMaterial{"diamond", kDiamond}),
                         [](const auto& test) { return std::string(test.param.name); });

/// A diffuse cavity of radius R and albedo a around a ball of radius r and radiance L in its centre. From anywhere on the
/// wall the ball fills f = (r/R)^2 of the cosine-weighted hemisphere, so the irradiance is pi L f times the sum of
/// (a (1 - f))^k over the k bounces from wall to wall; a camera in between sees a / pi of it.
TEST(Enclosure, CavityAroundABallHasTheRadianceOfItsSeries) {
    constexpr double kAlbedo = 0.8, kF = 0.09, kL = 5;
    for (const PathTracerOptions& options : {PathTracerOptions{}, kScatteringOnly}) {
        for (const int max_bounces : {1, 2, 5, 200}) {
            Scene scene = empty_scene(32, 32);
            scene.render.sampler = SamplerKind::independent;
            scene.render.max_bounces = max_bounces;
            look_at(scene, Vec3(0, 0, -1), Vec3(0, 0, -2), 60);
            const MaterialId wall = add_material(scene, Diffuse{{Color(static_cast<float>(kAlbedo)), nullptr}});
            const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(static_cast<float>(kL)), nullptr}});
            add_object(scene, Sphere{Vec3(0), 2}, wall);
            add_object(scene, Sphere{Vec3(0), 0.6f}, lamp);
            const double ratio = kAlbedo * (1 - kF);
            const double expected = kAlbedo * kL * kF * (1 - std::pow(ratio, max_bounces)) / (1 - ratio);
            SCOPED_TRACE("bounces " + std::to_string(max_bounces));
            expect_mean(render(scene, max_bounces > 5 ? 32 : 64, options)->film(), expected);
        }
    }
}

const PathTracerOptions kRouletteCases[] = {{}, {.light_sampling = false}, {.shortcuts = {.lobe_blocks = false}}};

/// The same, cut from the first scattering on: what light samples leave to find, and all of the light.
TEST(Roulette, KeepsTheMeanOfADarkCavity) {
    constexpr double kAlbedo = 0.05, kF = 0.25, kL = 5;
    for (const PathTracerOptions& options : kRouletteCases) {
        Scene scene = empty_scene(32, 32);
        scene.render.sampler = SamplerKind::independent;
        scene.render.max_bounces = 200;
        scene.render.rr_start = 1;
        look_at(scene, Vec3(0, 0, -1.5f), Vec3(0, 0, -2), 60);
        const MaterialId wall = add_material(scene, Diffuse{{Color(static_cast<float>(kAlbedo)), nullptr}});
        const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(static_cast<float>(kL)), nullptr}});
        add_object(scene, Sphere{Vec3(0), 2}, wall);
        add_object(scene, Sphere{Vec3(0), 1}, lamp);
        expect_mean(render(scene, 128, options)->film(), kAlbedo * kL * kF / (1 - kAlbedo * (1 - kF)));
    }
}

/// A dark ball under a sky shows its albedo times the sky.
TEST(Roulette, KeepsTheMeanOfADarkBall) {
    for (const PathTracerOptions& options : kRouletteCases) {
        Scene scene = empty_scene(32, 32);
        scene.render.sampler = SamplerKind::independent;
        scene.render.rr_start = 1;
        scene.environment = ConstantEnvironment{Color(2)};
        look_at(scene, Vec3(0, 0, 5), Vec3(0));
        add_object(scene, Sphere{Vec3(0), 1}, add_material(scene, Diffuse{{Color(0.05f), nullptr}}));
        expect_mean(render(scene, 128, options)->film(), 0.1);
    }
}

/// The inside of a two-sided emissive sphere lights a white floor point like a constant environment.
TEST(Enclosure, EmissiveSphereFromInsideIsAnEnvironment) {
    for (const PathTracerOptions& options : {PathTracerOptions{}, kScatteringOnly}) {
        Scene scene = empty_scene(16, 16);
        scene.render.sampler = SamplerKind::independent;
        look_at(scene, Vec3(0, 1, 0.2f), Vec3(0));
        add_object(scene, Quad{Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)},
                   add_material(scene, Diffuse{{Color(0.5f), nullptr}}));
        add_object(scene, Sphere{Vec3(0), 10}, add_material(scene, Emitter{{Color(3), nullptr}, true}));
        expect_mean(render(scene, 64, options)->film(), 1.5);
    }
}

/// Form factor from a horizontal element to a parallel a x b rectangle at height 1, the element under one corner.
double corner_form_factor(double a, double b) {
    const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
    return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * kPi);
}

TEST(DirectLight, QuadAboveAFloor) {
    for (const PathTracerOptions& options : {PathTracerOptions{}, PathTracerOptions{.mis = false}, kScatteringOnly}) {
        Scene scene = empty_scene(16, 16);
        scene.render.sampler = SamplerKind::independent;
        scene.render.max_bounces = 1;
        look_at(scene, Vec3(3, 0.5f, 0), Vec3(0));
        add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.6f), nullptr}}));
        const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(4), nullptr}});
        // Above the origin from (-1, -0.5) to (2, 1.5), facing down.
        add_object(scene, Quad{Vec3(-1, 1, -0.5f), Vec3(3, 0, 0), Vec3(0, 0, 2)}, lamp);
        const double form_factor = corner_form_factor(1, 0.5) + corner_form_factor(2, 0.5) +
                                   corner_form_factor(1, 1.5) + corner_form_factor(2, 1.5);
        expect_mean(render(scene, 256, options)->film(), 0.6 * 4 * form_factor, 4, 1e-4);
    }
}

TEST(DirectLight, QuadDoesNotShineBackwards) {
    Scene scene = empty_scene(8, 8);
    look_at(scene, Vec3(3, 0.5f, 0), Vec3(0));
    add_object(scene, Plane{}, add_material(scene, Diffuse{}));
    add_object(scene, Quad{Vec3(-1, 1, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)}, add_material(scene, Emitter{}));
    EXPECT_EQ(estimate(render(scene, 16)->film()).mean, 0);
    std::get<Emitter>(scene.materials[1].material).two_sided = true;
    EXPECT_GT(estimate(render(scene, 16)->film()).mean, 0);
}

TEST(DirectLight, SphereAboveAFloor) {
    for (const PathTracerOptions& options : {PathTracerOptions{}, PathTracerOptions{.mis = false}, kScatteringOnly}) {
        Scene scene = empty_scene(16, 16);
        scene.render.sampler = SamplerKind::independent;
        scene.render.max_bounces = 1;
        look_at(scene, Vec3(3, 0.5f, 0), Vec3(0));
        add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.6f), nullptr}}));
        add_object(scene, Sphere{Vec3(0, 3, -4), 1.5f}, add_material(scene, Emitter{.radiance = {Color(4), nullptr}}));
        // Wholly above the horizon: L (r / d)^2 cos, with d = 5 and cos = 3 / 5.
        expect_mean(render(scene, 512, options)->film(), 0.6 * 4 * 0.09 * 0.6, 4, 1e-4);
    }
}

/// A sampled environment image of one colour is the constant environment.
TEST(DirectLight, EnvironmentImageLightsLikeAConstant) {
    auto image = std::make_shared<Image>();
    image->width = 16;
    image->height = 8;
    image->pixels.assign(128, Vec4(2, 2, 2, 1));
    for (const PathTracerOptions& options : {PathTracerOptions{}, PathTracerOptions{.mis = false}, kScatteringOnly}) {
        Scene scene = empty_scene(16, 16);
        scene.render.sampler = SamplerKind::independent;
        look_at(scene, Vec3(3, 0.5f, 0), Vec3(0));
        scene.environment = ImageEnvironment{.file = "", .image = image};
        add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.25f), nullptr}}));
        expect_mean(render(scene, 128, options)->film(), 0.5);
    }
}

TEST(MaxBounces, CountsScatteringEvents) {
    Scene scene = empty_scene(8, 8);
    scene.environment = ConstantEnvironment{Color(1)};
    look_at(scene, Vec3(0, 0, 5), Vec3(0));
    const MaterialId mirror = add_material(scene, Metal{{Color(0.5f), nullptr}, {0, nullptr, 0}});
    add_object(scene, Quad{Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)}, mirror);
    scene.render.max_bounces = 0;
    EXPECT_EQ(estimate(render(scene, 2)->film()).mean, 0);
    scene.render.max_bounces = 1;
    EXPECT_NEAR(estimate(render(scene, 2)->film()).mean, 0.5, 1e-6);

    scene.objects.clear();
    scene.render.max_bounces = 0;
    EXPECT_NEAR(estimate(render(scene, 2)->film()).mean, 1, 1e-6);
    add_object(scene, Sphere{Vec3(0), 1}, add_material(scene, Emitter{.radiance = {Color(3), nullptr}}));
    EXPECT_NEAR(estimate(render(scene, 2)->film()).mean, 3, 1e-6);
}

TEST(MaxBounces, LightSamplesAreOneScattering) {
    Scene scene = empty_scene(8, 8);
    look_at(scene, Vec3(3, 0.5f, 0), Vec3(0));
    add_object(scene, Plane{}, add_material(scene, Diffuse{}));
    add_object(scene, Sphere{Vec3(0, 3, 0), 1}, add_material(scene, Emitter{}));
    scene.render.max_bounces = 0;
    EXPECT_EQ(estimate(render(scene, 4)->film()).mean, 0);
    scene.render.max_bounces = 1;
    EXPECT_GT(estimate(render(scene, 4)->film()).mean, 0);
}

/// Interpolated normals must not carry light through an opaque surface: a lamp inside of a closed mesh stays there.
TEST(Leaks, NothingComesThroughAClosedMesh) {
    Scene scene = empty_scene(48, 48);
    scene.camera.position = Vec3(0, 2, 3);
    scene.camera.target = Vec3(0);
    const MaterialId clay = add_material(scene, Diffuse{});
    const MaterialId lamp = add_material(scene, Emitter{.radiance = {Color(1000), nullptr}});
    const MaterialId steel = add_material(scene, Metal{{Color(0.9f), nullptr}, {0.6f, nullptr, 0}});
    for (const MaterialId material : {clay, steel}) {
        Scene closed = scene;
        add_object(closed, Mesh{"torus", torus_mesh(7, 5)}, material);
        for (int i = 0; i < 7; ++i) {
            const float angle = 2 * kPi * (static_cast<float>(i) + 0.5f) / 7;
            add_object(closed, Sphere{0.9f * Vec3(std::cos(angle), 0, std::sin(angle)), 0.1f}, lamp);
        }
        EXPECT_EQ(estimate(render(closed, 32)->film()).mean, 0);
    }
}

struct Variant {
    const char* name;
    PathTracerOptions options;
};

/// Ways to the same image: their differences, column by column, must be what chance allows.
TEST(Estimators, AgreeWithEachOther) {
    Scene scene = mixed_scene(64, 40);
    scene.render.sampler = SamplerKind::independent;
    const Variant variants[] = {{"all", {}},
                                {"scattering only", kScatteringOnly},
                                {"no mis", {.mis = false}},
                                {"no roulette", {.russian_roulette = false}}};
    constexpr int kColumns = 8;
    std::vector<std::vector<Estimate>> columns;
    for (const Variant& variant : variants) {
        scene.render.seed += 1;
        scene.render.rr_start = 2;
        const auto film = render(scene, variant.options.light_sampling ? 192 : 768, variant.options);
        auto& estimates = columns.emplace_back();
        for (int i = 0; i < kColumns; ++i) estimates.push_back(estimate(film->film(), i / 8.0, (i + 1) / 8.0));
    }
    for (std::size_t v = 1; v < columns.size(); ++v) {
        double chi_square = 0;
        for (int i = 0; i < kColumns; ++i) {
            const Estimate &a = columns[0][static_cast<std::size_t>(i)], &b = columns[v][static_cast<std::size_t>(i)];
            chi_square += (a.mean - b.mean) * (a.mean - b.mean) / (a.variance + b.variance);
        }
        EXPECT_LT(chi_square, 26.1) << variants[v].name << ": p < 0.001 at 8 degrees of freedom";
    }
}

TEST(Rejections, AreCountedAndLeaveOtherPixelsAlone) {
    Scene scene = empty_scene(32, 32);
    scene.environment = ConstantEnvironment{Color(1)};
    const MaterialId good = add_material(scene, Emitter{.radiance = {Color(2), nullptr}});
    add_object(scene, Sphere{Vec3(0, 1, 0), 0.5f}, good);
    const auto expected = render(scene, 4);
    std::get<Emitter>(scene.materials[0].material).radiance.value = Color(kInfinity);
    const auto got = render(scene, 4);
    std::uint64_t hits = 0;
    for (std::size_t i = 0; i < 32 * 32; ++i) {
        hits += 4 - got->film().count(i);
        if (got->film().count(i) == 4) {
            EXPECT_EQ(got->film().mean(i), expected->film().mean(i));
        }
        EXPECT_TRUE(std::isfinite(got->film().mean(i).x));
    }
    EXPECT_GT(hits, 0u);
    EXPECT_EQ(got->film().rejected()[static_cast<std::size_t>(Rejection::infinite)], hits);
}

}  // namespace
}  // namespace rayuela
