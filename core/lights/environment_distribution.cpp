#include "core/lights/environment_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

/// More cells than this gain nothing and cost cache misses.
constexpr double kMaxCells = 1 << 20;

float mean(const Vec4& pixel) {
    return (pixel.x + pixel.y + pixel.z) / 3;
}

/// Mean brightness over each pixel of a row, of the bilinear interpolation that EnvironmentLight returns: its integral
/// over a pixel takes 3/4 from the pixel and 1/8 from each neighbour, in each direction.
std::vector<float> row_brightness(const Image& image, int y) {
    const int above = std::max(y - 1, 0), below = std::min(y + 1, image.height - 1);
    std::vector<float> vertical(image.width), result(image.width);
    for (int x = 0; x < image.width; ++x) {
        vertical[x] = 0.75f * mean(image.at(x, y)) + 0.125f * (mean(image.at(x, above)) + mean(image.at(x, below)));
    }
    for (int x = 0; x < image.width; ++x) {
        const float left = vertical[x == 0 ? image.width - 1 : x - 1];
        const float right = vertical[x + 1 == image.width ? 0 : x + 1];
        result[x] = 0.75f * vertical[x] + 0.125f * (left + right);
    }
    return result;
}

/// cos(a) - cos(b) without cancellation.
double cosine_difference(double a, double b) {
    return 2 * std::sin((a + b) / 2) * std::sin((b - a) / 2);
}

}  // namespace

EnvironmentDistribution::EnvironmentDistribution(const EnvironmentLight& light) : light_(light) {
    const Image& image = *light_.image();
    const double pixels = static_cast<double>(image.width) * image.height;
    pixels_per_cell_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMaxCells))));
    const int columns = (image.width + pixels_per_cell_ - 1) / pixels_per_cell_;
    const int rows = (image.height + pixels_per_cell_ - 1) / pixels_per_cell_;
    std::vector<float> weights(static_cast<std::size_t>(columns) * rows, 0.0f);
    for (int y = 0; y < image.height; ++y) {
        const double step = std::numbers::pi / image.height;
        const auto solid_angle = static_cast<float>(cosine_difference(y * step, (y + 1) * step));
        const std::vector<float> brightness = row_brightness(image, y);
        float* cells = &weights[static_cast<std::size_t>(y / pixels_per_cell_) * columns];
        for (int x = 0; x < image.width; ++x) cells[x / pixels_per_cell_] += solid_angle * brightness[x];
    }
    cells_ = Distribution2D(weights, static_cast<std::uint32_t>(columns));
}

EnvironmentDistribution::Extent EnvironmentDistribution::extent(std::uint32_t cell, int pixels) const {
    const int first = static_cast<int>(cell) * pixels_per_cell_;
    return {static_cast<double>(first) / pixels,
            static_cast<double>(std::min(first + pixels_per_cell_, pixels)) / pixels};
}

float EnvironmentDistribution::solid_angle(std::uint32_t column, std::uint32_t row) const {
    const Extent x = extent(column, light_.image()->width), y = extent(row, light_.image()->height);
    return static_cast<float>(2 * std::numbers::pi * (x.end - x.begin) *
                              cosine_difference(std::numbers::pi * y.begin, std::numbers::pi * y.end));
}

std::optional<LightSample> EnvironmentDistribution::sample(const Vec2& u) const {
    const Distribution2D::Draw draw = cells_.draw(u);
    const Extent x = extent(draw.column, light_.image()->width), y = extent(draw.row, light_.image()->height);
    // Uniform per solid angle: (1 - cos(polar)) / 2 = sin^2(polar / 2) grows evenly.
    const double upper = std::sin(std::numbers::pi / 2 * y.begin), lower = std::sin(std::numbers::pi / 2 * y.end);
    const double half_sine = std::sqrt(glm::mix(upper * upper, lower * lower, static_cast<double>(draw.offset.y)));
    const double polar = 2 * std::asin(std::min(half_sine, 1.0));

    LightSample s;
    s.wi = light_.direction({static_cast<float>(glm::mix(x.begin, x.end, static_cast<double>(draw.offset.x))),
                             static_cast<float>(polar * std::numbers::inv_pi)});
    s.radiance = light_.radiance(s.wi);
    s.pdf = draw.probability / solid_angle(draw.column, draw.row);
    if (!(s.pdf > 0) || is_black(s.radiance)) return std::nullopt;
    return s;
}

float EnvironmentDistribution::pdf(const Vec3& wi) const {
    const Image& image = *light_.image();
    const Vec2 position = light_.image_position(wi);
    if (!(position.x >= 0 && position.y >= 0)) return 0;
    const auto cell = [&](float x, int pixels) {
        const int pixel = std::min(static_cast<int>(x * static_cast<float>(pixels)), pixels - 1);
        return static_cast<std::uint32_t>(pixel / pixels_per_cell_);
    };
    const std::uint32_t column = cell(position.x, image.width), row = cell(position.y, image.height);
    return cells_.probability(column, row) / solid_angle(column, row);
}

}  // namespace rayuela
