// Every example scene against its reference, by statistics.
//
// The references in reference/ are made by RAYUELA_REGENERATE_GOLDEN=1 ./dev test -R golden: without roulette, with
// independent samples, other seeds and a finer tree, so that a mistake in roulette, sampler or tree shows as a
// difference. Look at them before committing them. (That light sampling and scattering agree is tested in property/.)

#include "core/io/image_io.h"
#include "core/io/scene_reader.h"
#include "tests/golden/estimate.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace rayuela {

namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64;
constexpr int kBlock = 8;
/// With 63 degrees of freedom Student's t exceeds 6 with probability 1.1e-7: over some 1500 blocks and channels of all
/// scenes together that is 2e-4 (Sidak).
constexpr float kLimit = 6;
constexpr EstimateSettings kReference{
    .first_seed = 1000, .seeds = 64, .spp = 16, .options = {.russian_roulette = false}};
constexpr EstimateSettings kTested{.first_seed = 0, .seeds = 64, .spp = 3};

std::vector<std::string> example_scenes() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(fs::path(RAYUELA_ASSETS_DIR) / "scenes")) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".scene.json")) names.push_back(name.substr(0, name.find('.')));
    }
    std::sort(names.begin(), names.end());
    return names;
}

Scene load(const std::string& name) {
    auto loaded = read_scene(fs::path(RAYUELA_ASSETS_DIR) / "scenes" / (name + ".scene.json"));
    if (!loaded) throw std::runtime_error(to_string(loaded.error()));
    FilmSettings& film = loaded->scene.film;
    film.height = std::max(1, kWidth * film.height / film.width);
    film.width = kWidth;
    return loaded->scene;
}

fs::path reference_file(const std::string& name, const std::string& part) {
    return fs::path(RAYUELA_TESTS_DIR) / "golden" / "reference" / (name + part + ".exr");
}

void regenerate(const std::string& name) {
    Scene scene = load(name);
    scene.render.sampler = SamplerKind::independent;
    scene.render.accel = {AcceleratorKind::kd, 2, KdSplit::sah};
    const Estimate reference = estimate(scene, kReference);
    ASSERT_TRUE(write_image(reference_file(name, ""), reference.mean));
    ASSERT_TRUE(write_image(reference_file(name, ".error"), reference.error));
}

Estimate read_reference(const std::string& name) {
    const auto read = [&](const std::string& part) {
        const auto image = read_image(reference_file(name, part), ColorDecoding::linear);
        if (!image) throw std::runtime_error(to_string(image.error()));
        return **image;
    };
    return {read(""), read(".error")};
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, LooksLikeItsReference) {
    const std::string& name = GetParam();
    if (std::getenv("RAYUELA_REGENERATE_GOLDEN")) return regenerate(name);
    const Estimate reference = read_reference(name);
    const Estimate image = estimate(load(name), kTested);
    const Comparison comparison = compare(image, reference, kBlock);
    EXPECT_LT(comparison.worst, kLimit);
    EXPECT_LT(max_component(glm::abs(comparison.whole)), kLimit);
    if (HasFailure()) {
        for (const auto& [part, picture] : {std::pair("image", image.mean), std::pair("score", comparison.score)}) {
            const std::string file = "golden_" + name + "_" + part + ".exr";
            if (write_image(file, picture)) std::printf("see %s\n", fs::absolute(file).c_str());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(example_scenes()),
                         [](const auto& scene) { return scene.param; });

TEST(GoldenComparison, NoticesAnImageThatIsFourPercentBrighter) {
    const Estimate reference = read_reference("cornell");
    Estimate image = estimate(load("cornell"), kTested);
    for (Vec4& pixel : image.mean.pixels) pixel *= 1.04f;
    EXPECT_GT(max_component(glm::abs(compare(image, reference, kBlock).whole)), kLimit);
}

TEST(GoldenComparison, NoticesABlockThatIsBlack) {
    const Estimate reference = read_reference("cornell");
    Estimate image = estimate(load("cornell"), kTested);
    for (int y = 32; y < 40; ++y) {
        for (int x = 32; x < 40; ++x) image.mean.at(x, y) = Vec4(0);
    }
    EXPECT_GT(compare(image, reference, kBlock).worst, kLimit);
}

}  // namespace

}  // namespace rayuela
