#include "core/render/skips.h"

#include "core/accel/kd_accelerator.h"
#include "core/render/render_session.h"
#include "tests/render_testing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace rayuela {
namespace {

using namespace rayuela::testing;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Not;

std::shared_ptr<const Frame> glance_at(Scene scene) {
    scene.render.max_samples = 2;
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(std::make_shared<const Scene>(std::move(scene)));
    return session.wait({});
}

/// Names of what a render of the scene skips. Whatever is skipped has been done not once.
std::vector<std::string_view> skipped_in(const Scene& scene) {
    const auto frame = glance_at(scene);
    std::vector<std::string_view> names;
    for (const Skip& skip : skips_of(*frame->render_scene)) {
        EXPECT_FALSE(skip.why.empty()) << skip.name;
        EXPECT_TRUE(skip.state == SkipState::skipped || skip.saved == 0) << skip.name;
        if (skip.state != SkipState::skipped) continue;
        names.push_back(skip.name);
        EXPECT_EQ(skip.counter ? skip.counter(frame->statistics) : 0, 0u) << skip.name;
    }
    return names;
}

Skip skip_of(const Scene& scene, std::string_view name) {
    const std::vector<Skip> skips = skips_of(*make_render_scene(scene));
    const auto found = std::ranges::find(skips, name, &Skip::name);
    return found == skips.end() ? ADD_FAILURE() << name, Skip{} : *found;
}

/// A ball of the material on a floor of the other under a lamp.
Scene lit_ball(const Material& ball, const Material& floor = Diffuse{}) {
    Scene scene = empty_scene(32, 32);
    scene.camera.position = Vec3(0, 2, 6);
    scene.camera.target = Vec3(0, 1, 0);
    add_object(scene, Plane{}, add_material(scene, floor));
    add_object(scene, Sphere{Vec3(0, 1, 0), 1}, add_material(scene, ball));
    add_object(scene, Sphere{Vec3(1, 4, 1), 0.5f}, add_material(scene, Emitter{}));
    scene.environment = NoEnvironment{};
    return scene;
}

TEST(Skips, CountersOfWhatIsNeededAreNotZero) {
    Scene scene = mixed_scene(64, 36);
    scene.render.accel.leaf_size = 1;
    auto image = std::make_shared<Image>(Image{1, 1, {Vec4(0.5f)}, "grey"});
    std::get<Diffuse>(scene.materials[0].material).albedo.texture = image;
    const auto frame = glance_at(scene);
    for (const Skip& skip : skips_of(*frame->render_scene)) {
        if (!skip.counter) continue;
        EXPECT_EQ(skip.state, SkipState::needed) << skip.name;
        EXPECT_GT(skip.counter(frame->statistics), 0u) << skip.name;
    }
}

TEST(Skips, NoLightNoSearchForIt) {
    Scene scene = lit_ball(Diffuse{});
    scene.objects.pop_back();
    EXPECT_THAT(skipped_in(scene), AllOf(Contains("Shadow rays"), Contains("Bounces"), Contains("Environment"),
                                         Contains("Choice among lamps"), Contains("Paths from lamps")));
    EXPECT_EQ(make_render_scene(scene)->lights().memory_bytes(), 0u);
    EXPECT_EQ(make_render_scene(scene)->emission(), nullptr);
}

TEST(Skips, AnEvenSkyNeedsNoShadowRays) {
    Scene scene = lit_ball(Diffuse{});
    scene.objects.pop_back();
    for (const Environment& sky : {Environment(ConstantEnvironment{}), Environment(GradientEnvironment{})}) {
        scene.environment = sky;
        EXPECT_THAT(skipped_in(scene), AllOf(Contains("Shadow rays"), Contains("Light samples of the sky"),
                                             Not(Contains("Bounces")), Not(Contains("Environment"))));
        EXPECT_EQ(make_render_scene(scene)->lights().memory_bytes(), 0u);
    }
    scene.environment = ImageEnvironment{"sky", std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "sky"})};
    EXPECT_THAT(skipped_in(scene), AllOf(Not(Contains("Shadow rays")), Not(Contains("Light samples of the sky"))));
}

TEST(Skips, MirrorsAloneNeedNoShadowRays) {
    const std::vector<std::string_view> mirrors = skipped_in(lit_ball(Metal{}, Dielectric{}));
    EXPECT_THAT(mirrors, AllOf(Contains("Shadow rays"), Contains("Paths from lamps"), Not(Contains("Bounces"))));
    const std::vector<std::string_view> mirror_on_floor = skipped_in(lit_ball(Metal{}));
    EXPECT_THAT(mirror_on_floor, AllOf(Not(Contains("Shadow rays")), Not(Contains("Paths from lamps"))));
    EXPECT_EQ(skip_of(lit_ball(Metal{}), "Light samples on mirrors").saved, 2u) << "the ball and the lamp";
}

TEST(Skips, NoShadowRaysToLampsBehindTheSurfaceOrThatFaceAway) {
    Scene scene = lit_ball(Diffuse{});
    scene.objects.erase(scene.objects.begin() + 1);
    const auto shadow_rays = [&] { return glance_at(scene)->statistics.shadow_rays; };
    EXPECT_GT(shadow_rays(), 0u);
    std::get<Sphere>(scene.objects[1].shape).center.y = -4;
    EXPECT_EQ(shadow_rays(), 0u) << "below the floor";
    scene.objects[1].shape = Quad{Vec3(-1, 4, -1), Vec3(0, 0, 2), Vec3(2, 0, 0)};
    EXPECT_EQ(shadow_rays(), 0u) << "it shines upwards";
    scene.objects[1].shape = Quad{Vec3(-1, 4, -1), Vec3(2, 0, 0), Vec3(0, 0, 2)};
    EXPECT_GT(shadow_rays(), 0u);
}

TEST(Skips, NoPathsFromLampsWithoutCaustics) {
    EXPECT_THAT(skipped_in(lit_ball(Diffuse{})), AllOf(Contains("Paths from lamps"), Not(Contains("Shadow rays"))));
}

TEST(Skips, OneLightIsEditedWithoutARestart) {
    constexpr std::string_view kName = "Restarts by edits of light";
    Scene scene = lit_ball(Diffuse{});
    EXPECT_EQ(skip_of(scene, kName).state, SkipState::skipped);
    add_object(scene, Sphere{Vec3(3, 4, 1), 0.5f}, scene.objects[2].material);
    EXPECT_EQ(skip_of(scene, kName).state, SkipState::skipped) << "lamps of one material";
    scene.environment = ConstantEnvironment{};
    EXPECT_EQ(skip_of(scene, kName).state, SkipState::needed);
    EXPECT_THAT(skip_of(scene, kName).why, ::testing::HasSubstr("2 lights"));
    scene.objects.resize(2);
    EXPECT_EQ(skip_of(scene, kName).state, SkipState::skipped) << "the sky alone";
    scene.environment = NoEnvironment{};
    EXPECT_EQ(skip_of(scene, kName).state, SkipState::absent);
}

TEST(Skips, TexturesAreCountedWhereTheyAreSeen) {
    EXPECT_THAT(skipped_in(lit_ball(Diffuse{})), Contains("Textures"));
    Scene scene = lit_ball(Diffuse{{Color(1), std::make_shared<Image>(Image{1, 1, {Vec4(1)}, "white"})}});
    EXPECT_THAT(skipped_in(scene), Not(Contains("Textures")));
    scene.objects[1].visible = false;
    EXPECT_THAT(skipped_in(scene), Contains("Textures")) << "only a hidden object has one";
}

TEST(Skips, FewObjectsNeedNoTree) {
    Scene scene = lit_ball(Diffuse{});
    EXPECT_THAT(skipped_in(scene), AllOf(Contains("Cells of trees"), Contains("Tree over the objects")));
    scene.render.accel.leaf_size = 1;
    EXPECT_THAT(skipped_in(scene), Contains("Tree over the objects")) << "by the surface area heuristic none pays";
    scene.render.accel.split = KdSplit::median;
    EXPECT_THAT(skipped_in(scene), AllOf(Not(Contains("Cells of trees")), Not(Contains("Tree over the objects"))));
    scene.render.accel.split = KdSplit::sah;
    for (std::size_t i = 0; i < kFewObjects; ++i) add_object(scene, Sphere{Vec3(3 * static_cast<float>(i), 1, 9), 1});
    EXPECT_THAT(skipped_in(scene), AllOf(Not(Contains("Cells of trees")), Not(Contains("Tree over the objects"))));
    scene.render.accel.kind = AcceleratorKind::list;
    EXPECT_THAT(skipped_in(scene), AllOf(Contains("Cells of trees"), Contains("Tree over the objects")));
}

TEST(Skips, LargeObjectsStandBesideATreeOverTheOthers) {
    Scene scene = lit_ball(Diffuse{});
    EXPECT_EQ(skip_of(scene, "Large objects in leaves").state, SkipState::absent) << "there is no tree";
    for (std::size_t i = 0; i < kFewObjects; ++i)
        add_object(scene, Sphere{Vec3(static_cast<float>(i % 13), 1, static_cast<float>(i / 13)), 0.1f});
    EXPECT_EQ(skip_of(scene, "Large objects in leaves").state, SkipState::absent);
    add_object(scene, Sphere{Vec3(0, -1000, 0), 1000});
    EXPECT_EQ(skip_of(scene, "Large objects in leaves").state, SkipState::skipped);
    EXPECT_EQ(skip_of(scene, "Large objects in leaves").saved, 1u);
}

TEST(Skips, HiddenObjectsAreInNoTreeAndNoListOfLights) {
    Scene scene = lit_ball(Metal{});
    EXPECT_EQ(skip_of(scene, "Hidden objects").state, SkipState::absent);
    const ObjectId list = add_object(scene, ObjectList{});
    add_object(scene, Mesh{"torus", torus_mesh()}, scene.materials.back().id);
    scene.objects.back().parent = list;
    scene.objects[2].visible = scene.objects[3].visible = false;  // The lamp and the list.
    EXPECT_EQ(skip_of(scene, "Hidden objects").saved, 2u) << "the lamp and the list's member";
    const auto built = make_render_scene(scene);
    EXPECT_EQ(built->accelerator().instances().size(), 2u);
    EXPECT_EQ(built->accelerator().stats().primitives, 2u);
    EXPECT_TRUE(built->lights().empty());
    EXPECT_EQ(built->lights().memory_bytes(), 0u);
}

TEST(Skips, InstancesShareMeshAndTree) {
    Scene scene = lit_ball(Diffuse{});
    const auto torus = torus_mesh();
    const std::uint64_t bytes = torus->positions.size() * 24 + torus->triangles.size() * 12;
    add_object(scene, Mesh{"torus", torus});
    EXPECT_EQ(skip_of(scene, "Copies of meshes").saved, bytes);
    EXPECT_EQ(skip_of(scene, "Trees of instances").state, SkipState::absent);
    const std::uint64_t one_tree = make_render_scene(scene)->accelerator().stats().memory_bytes;
    add_object(scene, Mesh{"torus", torus}, {}, {.translate = Vec3(5)});
    add_object(scene, Mesh{"torus", torus}, {}, {.translate = Vec3(-5)});
    EXPECT_EQ(skip_of(scene, "Copies of meshes").saved, 3 * bytes);
    const std::uint64_t saved = skip_of(scene, "Trees of instances").saved;
    const std::uint64_t added = make_render_scene(scene)->accelerator().stats().memory_bytes - one_tree;
    EXPECT_GT(saved, 2 * 40 * torus->triangles.size()) << "twice ten floats a triangle at least";
    EXPECT_LT(added, saved / 10);
}

/// Three tori of one mesh, the last one hidden, whose texture coordinates are aside; counts how often they are read.
struct Tori {
    std::shared_ptr<int> reads = std::make_shared<int>(0);
    std::shared_ptr<TriangleMesh> mesh = std::make_shared<TriangleMesh>(*torus_mesh());
    std::uint64_t bytes = mesh->positions.size() * 8;
    Scene scene = lit_ball(Diffuse{});

    explicit Tori(bool aside) {
        std::vector<Vec2> uvs;
        for (const Vec3& p : mesh->positions) uvs.emplace_back(0.5f * p.x, 0.5f * p.y);
        if (aside) {
            mesh->uvs_aside = std::make_shared<const Lazy<std::vector<Vec2>>>([uvs, reads = reads] {
                ++*reads;
                return std::make_shared<const std::vector<Vec2>>(uvs);
            });
        } else {
            mesh->uvs = uvs;
        }
        for (const float x : {-2.0f, 2.0f, 0.0f})
            add_object(scene, Mesh{"torus", mesh}, add_material(scene, Diffuse{}), {.translate = Vec3(x, 1, 0)});
        scene.objects.back().visible = false;
    }
    /// A checkered image for the torus number i.
    void texture(std::size_t i) {
        auto image = std::make_shared<Image>(Image{2, 1, {Vec4(0.9f), Vec4(0.1f)}, "checker"});
        std::get<Diffuse>(scene.materials[3 + i].material).albedo.texture = image;
    }
};

TEST(Skips, TextureCoordinatesThatNobodyReadsAreNotInMemory) {
    Tori tori(true);
    const auto skip = [&] { return skip_of(tori.scene, "Texture coordinates of vertices"); };
    EXPECT_EQ(skip().state, SkipState::skipped);
    EXPECT_EQ(skip().saved, tori.bytes);
    tori.texture(2);
    EXPECT_EQ(skip().saved, tori.bytes) << "a texture that only a hidden object has";
    EXPECT_EQ(*tori.reads, 0);
    const std::uint64_t without = make_render_scene(tori.scene)->memory_bytes();

    tori.texture(0);
    tori.texture(1);
    {
        const auto built = make_render_scene(tori.scene);
        EXPECT_EQ(*tori.reads, 1) << "both tori share them";
        const std::uint64_t images = 2 * 2 * sizeof(Vec4);
        EXPECT_EQ(built->memory_bytes(), without + tori.bytes + images);
        const std::vector<Skip> skips = skips_of(*built);
        const auto found = std::ranges::find(skips, std::string_view("Texture coordinates of vertices"), &Skip::name);
        EXPECT_EQ(found->state, SkipState::needed);
        EXPECT_EQ(found->saved, 0u);
    }
    EXPECT_EQ(tori.mesh->bytes_aside(), tori.bytes) << "they go with the scene that reads them";
}

TEST(Skips, ATextureThatComesLaterFindsItsCoordinates) {
    Tori tori(true), plain(false);
    const auto before = make_render_scene(tori.scene);
    tori.texture(1);
    plain.texture(1);
    BuildControl control;
    const auto after = RenderScene::update(before.get(), std::make_shared<const Scene>(tori.scene),
                                           diff(before->scene(), tori.scene), control);
    EXPECT_EQ(control.total, 0u) << "no tree is built again";
    EXPECT_EQ(*tori.reads, 1);
    const auto expected = make_render_scene(plain.scene);
    const std::span<const GeometryInstance> instances = expected->accelerator().instances();
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        if (!std::holds_alternative<std::shared_ptr<const TriangleMesh>>(instances[i].shape)) continue;
        const Ray ray{.origin = Vec3(0, 5, 0), .direction = Vec3(0, -1, 0)};
        const Hit hit{.t = 1, .u = 0.25f, .v = 0.5f, .object = i, .primitive = 7};
        const bool textured = after->packed_material(i).textured;
        EXPECT_EQ(after->surfaces().point(ray, hit).uv == expected->surfaces().point(ray, hit).uv, true);
        EXPECT_EQ(after->surfaces().point(ray, hit).uv == Vec2(0.25f, 0.5f), !textured);
    }
    const auto image_of = [](const Scene& scene) { return glance_at(scene)->image.pixels; };
    EXPECT_EQ(image_of(tori.scene), image_of(plain.scene));
}

/// An image of one colour that counts how often it is decoded.
std::shared_ptr<const Image> encoded_image(const std::shared_ptr<int>& decoded, bool works = true) {
    Image image{2, 2, {}, "picture"};
    image.encoded = std::make_shared<const Lazy<Image>>(
        [=]() -> std::shared_ptr<const Image> {
            ++*decoded;
            if (!works) return nullptr;
            return std::make_shared<const Image>(Image{2, 2, std::vector<Vec4>(4, Vec4(0.25f)), "picture"});
        },
        7);
    return std::make_shared<const Image>(image);
}

TEST(Skips, ImagesAreDecodedForWhatIsSeen) {
    const auto decoded = std::make_shared<int>(0);
    const auto image = encoded_image(decoded);
    Scene scene = lit_ball(Diffuse{});
    EXPECT_EQ(skip_of(scene, "Pixels of textures").state, SkipState::absent);
    const MaterialId textured = add_material(scene, Diffuse{{Color(1), image}});
    add_material(scene, Metal{{Color(1), image}});
    EXPECT_EQ(skip_of(scene, "Pixels of textures").saved, 4 * sizeof(Vec4)) << "nothing has the materials";
    add_object(scene, Sphere{Vec3(2, 1, 0), 1}, textured);
    scene.objects.back().visible = false;
    EXPECT_EQ(skip_of(scene, "Pixels of textures").state, SkipState::skipped);
    const auto before = make_render_scene(scene);
    EXPECT_EQ(*decoded, 0);

    scene.objects.back().visible = true;
    BuildControl control;
    const auto after =
        RenderScene::update(before.get(), std::make_shared<const Scene>(scene), diff(before->scene(), scene), control);
    EXPECT_EQ(*decoded, 1);
    EXPECT_EQ(skip_of(scene, "Pixels of textures").state, SkipState::needed);
    EXPECT_EQ(*decoded, 1) << "another render scene shares the pixels";
    EXPECT_TRUE(after->problems().empty());

    Scene plain = scene;
    std::get<Diffuse>(plain.materials[3].material).albedo.texture = with_pixels(image);
    EXPECT_EQ(glance_at(scene)->image.pixels, glance_at(plain)->image.pixels);
}

TEST(Skips, AnImageThatDoesNotDecodeAfterAllIsTold) {
    const auto tried = std::make_shared<int>(0);
    Scene scene = lit_ball(Diffuse{{Color(0.5f), encoded_image(tried, false)}});
    const auto built = make_render_scene(scene);
    ASSERT_EQ(built->problems().size(), 1u);
    EXPECT_EQ(built->problems()[0].file, "picture");
    EXPECT_FALSE(built->features().textures) << "it is shown without the image";
    scene.objects[1].visible = false;
    EXPECT_TRUE(make_render_scene(scene)->problems().empty());
}

TEST(Skips, AttributesThatAMeshLacksTakeNoMemory) {
    Scene scene = lit_ball(Diffuse{});
    EXPECT_EQ(skip_of(scene, "Texture coordinates of vertices").state, SkipState::absent) << "no mesh";
    const auto torus = torus_mesh();
    add_object(scene, Mesh{"torus", torus});
    EXPECT_EQ(skip_of(scene, "Texture coordinates of vertices").saved, torus->positions.size() * 8);
    EXPECT_EQ(skip_of(scene, "Normals of vertices").state, SkipState::needed);
}

}  // namespace
}  // namespace rayuela
