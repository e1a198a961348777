#include "core/render/progressive_renderer.h"

#include "tests/render_testing.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

using namespace rayuela::testing;

void take(ProgressiveRenderer& renderer, const Scene& scene) {
    BuildControl control;
    ASSERT_TRUE(renderer.take(std::make_shared<const Scene>(scene), control));
}

/// New mail may keep a finished film from being shown; if the mail changes nothing in the image, it still must be.
TEST(ProgressiveRenderer, AFilmThatNobodySawIsDueAfterAnEditThatKeepsIt) {
    Scene scene = empty_scene(16, 16);
    scene.environment = ConstantEnvironment{Color(1)};
    scene.render.max_samples = 1;
    ProgressiveRenderer renderer(false, 1, {});
    take(renderer, scene);
    std::atomic<std::uint64_t> paths_done{0};
    renderer.render(renderer.next_pass(), std::atomic<bool>(false), paths_done);
    ASSERT_EQ(renderer.next_pass().kind, Pass::Kind::finished);
    EXPECT_TRUE(renderer.publication_due());
    scene.render.accel.leaf_size = 1;
    take(renderer, scene);
    EXPECT_EQ(renderer.next_pass().kind, Pass::Kind::finished);
    EXPECT_TRUE(renderer.publication_due());
}

}  // namespace
}  // namespace rayuela
