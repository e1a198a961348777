#pragma once

#include "core/render/frame.h"
#include "ui/view_settings.h"

#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace rayuela {

/// What one drawing of the image depends on besides the frame. Pixels of the target, from its upper left corner.
struct DisplayRequest {
    glm::ivec2 size{0};  ///< Of the target.
    Vec2 origin{0};      ///< The image's upper left corner.
    float zoom = 1;      ///< Target pixels an image pixel.
    float exposure = 0;
    ToneMap tone_map = ToneMap::linear;
    float checker_size = 12;  ///< Of the squares beside the image.
    float outline_width = 0;
    std::vector<ObjectId> outlined;

    bool operator==(const DisplayRequest&) const = default;
};

/// Draws frames into a texture with shaders/display.frag. What has not changed is neither uploaded (by tiles) nor drawn
/// again, and a preview, which has little detail, is drawn small: enlarging it is cheap where OpenGL runs in software.
/// Lives and dies with its OpenGL context current.
class Display {
public:
    Display();
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    /// A texture to be stretched over the size asked for. Its rows run upwards, as OpenGL's do.
    struct Picture {
        unsigned texture = 0;    ///< 0 where that size is 0.
        Vec2 lower_right{1, 0};  ///< Texture coordinates of that corner; the upper left one has (0, 1).
    };
    Picture draw(const std::shared_ptr<const Frame>& frame, const DisplayRequest& request);

    struct Statistics {
        std::uint64_t uploads = 0;
        std::uint64_t uploaded_pixels = 0;
        std::uint64_t draws = 0;
        double upload_seconds = 0;  ///< Of the last upload.
    };
    const Statistics& statistics() const { return statistics_; }

private:
    void upload_film(const std::shared_ptr<const Frame>& frame);
    void upload_mask(const Frame& frame, const std::vector<ObjectId>& outlined);
    void prepare_target(glm::ivec2 size, bool enlarged);
    void draw_film(const Frame& frame, const DisplayRequest& request);

    void draw_triangle(const Frame& frame, const DisplayRequest& request, bool outline);
    /// The program for one use of display.frag, compiled when it is first needed.
    unsigned program(ToneMap tone_map, bool smooth, bool outline);

    std::map<std::tuple<ToneMap, bool, bool>, unsigned> programs_;
    unsigned vertex_array_ = 0;
    unsigned film_ = 0, mask_ = 0;
    unsigned target_ = 0, framebuffer_ = 0;
    std::shared_ptr<const Frame> uploaded_;  ///< What `film_` holds.
    glm::ivec2 film_size_{0}, mask_size_{0}, target_size_{0};
    glm::ivec4 mask_bounds_{0};
    Vec2 lower_right_{1, 0};
    std::uint64_t mask_version_ = 0, drawn_version_ = 0;
    std::vector<ObjectId> masked_;
    DisplayRequest drawn_;
    Statistics statistics_;
};

/// The object and, of a list, everything in it.
std::vector<ObjectId> with_children(const Scene& scene, ObjectId id);

}  // namespace rayuela
