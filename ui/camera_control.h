#pragma once

#include "ui/editor.h"
#include "ui/image_view.h"

namespace rayuela {

/// The part of the viewport that shows the image. Coordinates are ImGui's.
struct Canvas {
    Vec2 corner{0};  ///< Upper left.
    Vec2 size{0};
    Vec2 image_size{0};  ///< Of the film, film pixels.
    float density = 1;   ///< Framebuffer pixels an ImGui unit.

    /// Where the image lies, in framebuffer pixels from the corner.
    ImageView view(const ViewSettings& settings) const { return image_view(settings, size * density, image_size); }
    /// Film pixels, from ImGui's coordinates.
    Vec2 to_image(const ViewSettings& settings, const Vec2& position) const {
        return view(settings).to_image((position - corner) * density);
    }
};

/// What a click on `hit` selects: the object, or, where that is selected already, the group that it belongs to, and so on
/// up to the outermost; then the object again.
ObjectId next_selection(const Scene& scene, std::optional<ObjectId> selected, ObjectId hit);

/// What the mouse and keyboard do to the camera, the selection and the zoom, over the image. The last ImGui item must be
/// the image's.
class CameraControl {
public:
    void update(Editor& editor, const Canvas& canvas);
    /// Moves without events, so that frames must follow one another.
    bool is_flying() const { return flying_; }

private:
    void drag(Editor& editor, const Canvas& canvas);
    void fly(Editor& editor, const Canvas& canvas);
    void wheel(Editor& editor, const Canvas& canvas);
    void click(Editor& editor, const Canvas& canvas);

    bool flying_ = false;
};

}  // namespace rayuela
