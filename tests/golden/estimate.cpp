#include "tests/golden/estimate.h"

#include "core/render/accumulation.h"

namespace rayuela {

namespace {

std::size_t size(const Image& image) {
    return image.pixels.size();
}

Image blank(int width, int height) {
    return {width, height, std::vector<Vec4>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

struct Block {
    Vec3d mean{0}, variance{0};
};

Block average(const Estimate& image, int x0, int y0, int x1, int y1) {
    Block block;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            block.mean += Vec3d(image.mean.at(x, y));
            const Vec3d error(image.error.at(x, y));
            block.variance += error * error;
        }
    }
    const double pixels = static_cast<double>(x1 - x0) * (y1 - y0);
    return {block.mean / pixels, block.variance / (pixels * pixels)};
}

Vec3 score(const Block& a, const Block& b) {
    Vec3 result{0};
    for (int channel = 0; channel < 3; ++channel) {
        const double difference = a.mean[channel] - b.mean[channel];
        // Where both are exact (a flat background) the floats they are kept in still round.
        const double rounding = std::ldexp(std::abs(b.mean[channel]), -22);
        const double spread = std::sqrt(a.variance[channel] + b.variance[channel]) + rounding;
        if (difference != 0) result[channel] = static_cast<float>(difference / spread);
    }
    return result;
}

}  // namespace

Estimate estimate(const Scene& scene, const EstimateSettings& settings) {
    const int width = scene.film.width, height = scene.film.height;
    Estimate result{blank(width, height), blank(width, height)};
    std::vector<Vec3d> sum(size(result.mean), Vec3d(0)), squares(size(result.mean), Vec3d(0));

    std::shared_ptr<const RenderScene> render_scene;
    std::shared_ptr<const Scene> previous;
    Accumulation accumulation(width, height);
    for (int i = 0; i < settings.seeds; ++i) {
        auto seeded = std::make_shared<Scene>(scene);
        seeded->render.seed = settings.first_seed + static_cast<std::uint32_t>(i);
        BuildControl build;
        render_scene =
            RenderScene::update(render_scene.get(), seeded, previous ? diff(*previous, *seeded) : all_changes(), build);
        previous = seeded;
        accumulation.restart();
        const std::atomic<bool> cancelled{false};
        std::atomic<std::uint64_t> done{0};
        PassControl control{.cancelled = cancelled, .paths_done = done};
        accumulation.add_samples(PathTracer(*render_scene, width, height, settings.options), settings.spp, control);
        for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) {
            const Vec3d value = accumulation.film().mean(pixel);
            sum[pixel] += value;
            squares[pixel] += value * value;
        }
    }
    const double n = settings.seeds;
    for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) {
        const Vec3d mean = sum[pixel] / n;
        const Vec3d variance = glm::max((squares[pixel] / n - mean * mean) / (n - 1), Vec3d(0));
        result.mean.pixels[pixel] = Vec4(Vec3(mean), 1);
        result.error.pixels[pixel] = Vec4(Vec3(glm::sqrt(variance)), 1);
    }
    return result;
}

Comparison compare(const Estimate& a, const Estimate& b, int block) {
    const int width = a.mean.width, height = a.mean.height;
    Comparison result{blank((width + block - 1) / block, (height + block - 1) / block)};
    for (int y = 0; y < result.score.height; ++y) {
        for (int x = 0; x < result.score.width; ++x) {
            const int x0 = x * block, y0 = y * block, x1 = std::min(width, x0 + block),
                      y1 = std::min(height, y0 + block);
            const Vec3 scores = score(average(a, x0, y0, x1, y1), average(b, x0, y0, x1, y1));
            result.score.at(x, y) = Vec4(scores, 1);
            result.worst = std::max(result.worst, max_component(glm::abs(scores)));
        }
    }
    result.whole = score(average(a, 0, 0, width, height), average(b, 0, 0, width, height));
    return result;
}

}  // namespace rayuela
