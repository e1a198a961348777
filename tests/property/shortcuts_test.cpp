#include "core/io/scene_reader.h"
#include "core/math/isa.h"
#include "core/render/progressive_renderer.h"
#include "core/render/skips.h"
#include "tests/render_testing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace rayuela {
namespace {

namespace fs = std::filesystem;
using namespace rayuela::testing;

constexpr int kSamples = 2;

std::shared_ptr<const Frame> render_with(const Scene& scene, const Shortcuts& shortcuts) {
    ProgressiveRenderer renderer(false, 2, {.shortcuts = shortcuts});
    BuildControl control;
    renderer.take(std::make_shared<const Scene>(scene), control);
    const std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> done{0};
    renderer.render({.samples = kSamples}, cancelled, done);
    return renderer.publish(SessionPhase::rendering);
}

/// Each shortcut alone put back, all of them, and on each set of instructions none and all.
void expect_the_same_image(Scene scene, const std::string& name) {
    scene.film.height = std::max(1, 40 * scene.film.height / scene.film.width);
    scene.film.width = 40;
    const auto expected = render_with(scene, {});
    const auto expect_same = [&](const Shortcuts& shortcuts, std::string_view what) {
        EXPECT_EQ(render_with(scene, shortcuts)->image.pixels, expected->image.pixels) << name << " " << what;
    };
    Shortcuts none;
    for (const ShortcutField& field : kShortcuts) {
        Shortcuts others;
        others.*field.member = none.*field.member = false;
        expect_same(others, field.key);
    }
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        expect_same({}, set);
        expect_same(none, set);
    }
    use_instruction_set(instruction_sets().front());
}

std::vector<std::string> examples() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(fs::path(RAYUELA_ASSETS_DIR) / "scenes"))
        names.push_back(entry.path().stem().stem().string());
    std::ranges::sort(names);
    return names;
}

class EachExample : public ::testing::TestWithParam<std::string> {};

TEST_P(EachExample, IsTheSameWithEveryFormOfItsStages) {
    const auto loaded = read_scene(fs::path(RAYUELA_ASSETS_DIR) / "scenes" / (GetParam() + ".scene.json"));
    ASSERT_TRUE(loaded);
    expect_the_same_image(loaded->scene, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Shortcuts, EachExample, ::testing::ValuesIn(examples()),
                         [](const auto& name) { return name.param; });

TEST(Shortcuts, ChangeNoImageOfASceneWithoutLight) {
    Scene scene = mixed_scene(40, 30);
    scene.environment = NoEnvironment{};
    expect_the_same_image(scene, "no sky");
    std::erase_if(scene.objects, [&](const Object& object) {
        const auto entry = std::ranges::find(scene.materials, object.material, &MaterialEntry::id);
        return entry != scene.materials.end() && is_emissive(entry->material);
    });
    const auto dark = render_with(scene, {});
    EXPECT_EQ(dark->statistics.rays, dark->statistics.samples) << "nothing bounces";
    expect_the_same_image(scene, "no light");
}

/// What is put back is done indeed: its counter says so, or counts more than before.
TEST(Shortcuts, WorkThatIsPutBackIsCounted) {
    Scene scene = mixed_scene(40, 30);
    scene.environment = NoEnvironment{};
    const auto plain = render_with(scene, {});
    EXPECT_EQ(plain->statistics.environment_lookups, 0u);
    EXPECT_GT(render_with(scene, {.no_sky = false})->statistics.environment_lookups, 0u);
    EXPECT_EQ(plain->statistics.textured_hits, 0u);
    EXPECT_GT(render_with(scene, {.ready_materials = false})->statistics.textured_hits, 0u);
    EXPECT_GT(render_with(scene, {.black_shadow_rays = false})->statistics.shadow_rays, plain->statistics.shadow_rays);
}

TEST(Shortcuts, ATreeOverFewObjectsCanBePutBack) {
    Scene scene = mixed_scene(40, 30);
    for (int i = 0; i < 60; ++i) add_object(scene, Sphere{Vec3(3 * (i % 8), 3 * (i / 8), -20), 1});
    const auto nodes = [&](const Shortcuts& shortcuts) {
        return render_with(scene, shortcuts)->statistics.accel.nodes;
    };
    EXPECT_GT(nodes({.few_objects = false}), nodes({}));
    const auto with_tree = render_with(scene, {.few_objects = false});
    const std::vector<Skip> skips = skips_of(*with_tree);
    const auto tree = std::ranges::find(skips, std::string_view("Tree over the objects"), &Skip::name);
    EXPECT_EQ(tree->state, SkipState::put_back);
}

/// Each shortcut has its line in the table, so that the panel has a box for it.
TEST(Shortcuts, EachHasALineAmongTheSkips) {
    const std::vector<Skip> skips = skips_of(*make_render_scene(mixed_scene(40, 30)));
    for (const ShortcutField& field : kShortcuts) {
        EXPECT_EQ(std::ranges::count_if(skips, [&](const Skip& skip) { return skip.shortcut == &field; }), 1)
            << field.key;
    }
}

}  // namespace
}  // namespace rayuela
