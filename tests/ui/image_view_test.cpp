#include "ui/image_view.h"

#include <gtest/gtest.h>

namespace rayuela {
namespace {

const Vec2 kViewport(1000, 600), kImage(400, 300);

TEST(ImageView, FitTouchesTheShorterSideAndCentres) {
    const ImageView view = image_view(ViewSettings{}, kViewport, kImage);
    EXPECT_FLOAT_EQ(view.zoom, 2);
    EXPECT_EQ(view.origin, Vec2(100, 0));
    EXPECT_EQ(view.to_image(Vec2(500, 300)), Vec2(200, 150));
}

TEST(ImageView, AFilmOfTheViewportsSizeIsShownPixelForPixel) {
    const ImageView view = image_view(ViewSettings{}, kViewport, kViewport);
    EXPECT_EQ(view.zoom, 1);
    EXPECT_EQ(view.origin, Vec2(0));
}

TEST(ImageView, OneToOneLiesOnWholePixels) {
    ViewSettings view;
    view.fit = false;
    const ImageView shown = image_view(view, Vec2(1001, 601), kImage);
    EXPECT_EQ(shown.zoom, 1);
    EXPECT_EQ(shown.origin, glm::round(shown.origin));
}

TEST(ImageView, ZoomKeepsThePixelUnderTheMouse) {
    ViewSettings view;
    const Vec2 mouse(321, 123);
    const Vec2 pixel = image_view(view, kViewport, kImage).to_image(mouse);
    for (int i = 0; i < 12; ++i) {
        view = zoomed_at(view, kViewport, kImage, mouse, 1.25f);
        EXPECT_FALSE(view.fit);
        const ImageView shown = image_view(view, kViewport, kImage);
        // The origin is rounded to whole pixels of the viewport.
        EXPECT_LE(glm::distance(shown.to_viewport(pixel), mouse), 1.0f) << shown.zoom;
    }
    EXPECT_GT(view.zoom, 16);
}

TEST(ImageView, ZoomIsLimited) {
    ViewSettings view;
    for (int i = 0; i < 100; ++i) {
        view = zoomed_at(view, kViewport, kImage, Vec2(10), 1.5f);
    }
    EXPECT_EQ(view.zoom, kMaxZoom);
    for (int i = 0; i < 200; ++i) {
        view = zoomed_at(view, kViewport, kImage, Vec2(10), 0.7f);
    }
    EXPECT_EQ(view.zoom, kMinZoom);
}

TEST(ImageView, ZoomLandsOnWholeNumbersButLeavesThem) {
    ViewSettings view;
    view.fit = false;
    view.zoom = 1.95f;
    view = zoomed_at(view, kViewport, kImage, Vec2(0), 1.01f);
    EXPECT_EQ(view.zoom, 2);
    for (int i = 0; i < 10; ++i) {
        view = zoomed_at(view, kViewport, kImage, Vec2(0), 1.01f);
    }
    EXPECT_NEAR(view.zoom, 2 * std::pow(1.01f, 10.0f), 0.02f);
}

TEST(ImageView, PanMovesByPixelsOfTheViewport) {
    ViewSettings view;
    view.fit = false;
    view.zoom = 4;
    const ImageView before = image_view(view, kViewport, kImage);
    const ImageView after = image_view(panned(view, kViewport, kImage, Vec2(30, -20)), kViewport, kImage);
    EXPECT_EQ(after.origin - before.origin, Vec2(30, -20));
}

TEST(ImageView, NoImageIsNoDivisionByZero) {
    EXPECT_EQ(image_view(ViewSettings{}, kViewport, Vec2(0)).zoom, 1);
}

}  // namespace
}  // namespace rayuela
