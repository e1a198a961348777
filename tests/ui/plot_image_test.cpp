#include "ui/plot_image.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayuela {
namespace {

constexpr Vec3 kBlue{0, 0, 1}, kRed{1, 0, 0};

/// Where a line of this colour is. Its edges are blended with what lies behind.
std::vector<glm::dvec2> pixels_of(const Image& image, const Vec3& color) {
    std::vector<glm::dvec2> found;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (glm::distance(Vec3(image.at(x, y)), color) < 0.5f) found.emplace_back(x, y);
        }
    }
    return found;
}

PlotCurve make_curve(std::string name, const Vec3& color, double power) {
    PlotCurve curve{.name = std::move(name), .color = color, .x = {1, 3, 40, 100}, .y = {}, .low = {}, .high = {}};
    for (const double x : curve.x) {
        curve.y.push_back(std::pow(x, power));
        curve.low.push_back(curve.y.back() / 1.5);
        curve.high.push_back(curve.y.back() * 1.5);
    }
    return curve;
}

PlotSheet make_sheet(std::vector<PlotCurve> curves) {
    PlotPanel panel{.title = "panel", .curves = std::move(curves), .guide_x = {1, 100}, .guide_y = {1, 0.01}};
    return {.x_label = "x", .y_label = "y", .panels = {std::move(panel)}, .columns = 1};
}

/// Steepness of the least-squares line, pixels a pixel, and the largest distance from it.
std::pair<double, double> fit_line(const std::vector<glm::dvec2>& points) {
    glm::dvec2 mean(0);
    for (const glm::dvec2& p : points) mean += p / static_cast<double>(points.size());
    double xx = 0, xy = 0, distance = 0;
    for (const glm::dvec2& p : points) {
        xx += (p.x - mean.x) * (p.x - mean.x);
        xy += (p.x - mean.x) * (p.y - mean.y);
    }
    for (const glm::dvec2& p : points) distance = std::max(distance, std::abs(p.y - mean.y - xy / xx * (p.x - mean.x)));
    return {xy / xx, distance};
}

TEST(PlotImageTest, PowersAreStraightLinesOnLogLogScales) {
    const Result<Image> image = plot_image(make_sheet({make_curve("-1", kBlue, -1)}));
    ASSERT_TRUE(image);
    const std::vector<glm::dvec2> points = pixels_of(*image, kBlue);
    ASSERT_GT(points.size(), 300u);
    const auto [slope, distance] = fit_line(points);
    EXPECT_GT(slope, 0.3) << "falls: rows count from the top";
    EXPECT_LT(distance, 6) << "straight";
    EXPECT_GT(points.back().y - points.front().y, image->height / 2) << "the axes fit the curve";
}

TEST(PlotImageTest, SlopesCompareAndEveryPanelHasItsPlace) {
    PlotSheet sheet = make_sheet({make_curve("-1", kBlue, -1), make_curve("-2", kRed, -2)});
    const Result<Image> one = plot_image(sheet);
    ASSERT_TRUE(one);
    // The legend shows the colours too, in level strokes.
    const double blue = fit_line(pixels_of(*one, kBlue)).first, red = fit_line(pixels_of(*one, kRed)).first;
    EXPECT_GT(red, 1.4 * blue);
    sheet.panels.resize(5, sheet.panels[0]);
    sheet.columns = 3;
    const Result<Image> five = plot_image(sheet);
    ASSERT_TRUE(five);
    EXPECT_EQ(five->width, 3 * one->width);
    EXPECT_EQ(five->height, 2 * one->height);
    EXPECT_NEAR(static_cast<double>(pixels_of(*five, kBlue).size()),
                5.0 * static_cast<double>(pixels_of(*one, kBlue).size()),
                0.2 * static_cast<double>(pixels_of(*five, kBlue).size()));
}

}  // namespace
}  // namespace rayuela
