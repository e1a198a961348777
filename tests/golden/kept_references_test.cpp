// The references that `bench convergence` compares with, in assets/references: two halves a scene, made by
// ./dev references.

#include "core/io/image_io.h"
#include "core/io/scene_reader.h"
#include "tests/golden/estimate.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace rayuela {

namespace {

namespace fs = std::filesystem;

/// As in golden_test.cpp; the estimates below have as many degrees of freedom.
constexpr float kLimit = 6;
constexpr int kBlock = 16;
constexpr EstimateSettings kTested{.first_seed = 0, .seeds = 64, .spp = 1};

fs::path folder() {
    return fs::path(RAYUELA_ASSETS_DIR) / "references";
}

std::vector<std::string> kept_references() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder())) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with("_a.exr")) names.push_back(name.substr(0, name.size() - 6));
    }
    std::sort(names.begin(), names.end());
    return names;
}

Image half(const std::string& name, const char* which) {
    const auto image = read_image(folder() / (name + which + ".exr"), ColorDecoding::linear);
    if (!image) throw std::runtime_error(to_string(image.error()));
    return **image;
}

/// Two values have the standard error |a - b| / 2 of their mean: rough for a pixel, good for a block of them.
Estimate mean_of_halves(const Image& a, const Image& b) {
    Estimate result{a, a};
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        result.mean.pixels[i] = (a.pixels[i] + b.pixels[i]) / 2.0f;
        result.error.pixels[i] = glm::abs(a.pixels[i] - b.pixels[i]) / 2.0f;
    }
    return result;
}

class KeptReference : public testing::TestWithParam<std::string> {};

TEST_P(KeptReference, AgreesWithAShortRender) {
    const Image a = half(GetParam(), "_a"), b = half(GetParam(), "_b");
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    EXPECT_NE(a.pixels, b.pixels) << "the halves are independent";
    auto loaded = read_scene(fs::path(RAYUELA_ASSETS_DIR) / "scenes" / (GetParam() + ".scene.json"));
    ASSERT_TRUE(loaded);
    FilmSettings& film = loaded->scene.film;
    ASSERT_EQ(film.width * a.height, film.height * a.width) << "not the shape of the scene's film";
    film.width = a.width;
    film.height = a.height;
    const Comparison comparison = compare(estimate(loaded->scene, kTested), mean_of_halves(a, b), kBlock);
    EXPECT_LT(comparison.worst, kLimit);
    EXPECT_LT(max_component(glm::abs(comparison.whole)), kLimit);
}

INSTANTIATE_TEST_SUITE_P(Scenes, KeptReference, testing::ValuesIn(kept_references()),
                         [](const auto& scene) { return scene.param; });

}  // namespace

}  // namespace rayuela
