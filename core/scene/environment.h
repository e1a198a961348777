#pragma once

#include "core/math/field.h"
#include "core/math/image.h"

#include <array>
#include <memory>
#include <string>
#include <variant>

namespace rayuela {

// Each kind has
//     light()    what its light is in proportion to, channel by channel: all of these together;
//     put_out()  sets them to 0.

/// No light from outside.
struct NoEnvironment {
    static constexpr std::string_view kType = "none", kLabel = "None", kTip = "Black: only emitters give light.";

    template <typename Self, typename Visitor>
    static void visit_fields(Self&, Visitor&&) {}
    std::array<Color, 0> light() const { return {}; }
    void put_out() {}
    bool operator==(const NoEnvironment&) const = default;
};

/// The same radiance from everywhere.
struct ConstantEnvironment {
    static constexpr std::string_view kType = "constant", kLabel = "Constant", kTip = "The same light from everywhere.";

    Color radiance{1};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.radiance, Field{.key = "radiance",
                                   .label = "Radiance",
                                   .tip = "Light from every direction.",
                                   .role = FieldRole::radiance,
                                   .min = 0,
                                   .soft_min = 0,
                                   .soft_max = 2});
    }
    std::array<Color, 1> light() const { return {radiance}; }
    void put_out() { radiance = Color(0); }
    bool operator==(const ConstantEnvironment&) const = default;
};

/// Shirley's sky: from bottom to top by (y + 1) / 2 of the unit direction.
struct GradientEnvironment {
    static constexpr std::string_view kType = "gradient", kLabel = "Gradient",
                                      kTip = "A sky from one colour to another.";

    Color bottom{1};
    Color top{0.5f, 0.7f, 1.0f};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.bottom, Field{.key = "bottom",
                                 .label = "Bottom",
                                 .tip = "Light from straight below.",
                                 .role = FieldRole::radiance,
                                 .min = 0,
                                 .soft_min = 0,
                                 .soft_max = 2});
        visit(self.top, Field{.key = "top",
                              .label = "Top",
                              .tip = "Light from straight above.",
                              .role = FieldRole::radiance,
                              .min = 0,
                              .soft_min = 0,
                              .soft_max = 2});
    }
    std::array<Color, 2> light() const { return {bottom, top}; }
    void put_out() { bottom = top = Color(0); }
    bool operator==(const GradientEnvironment&) const = default;
};

/// Equirectangular image: its centre lies towards -z, u grows to the right (seen from inside), v to the top; rotation
/// turns it about +y.
struct ImageEnvironment {
    static constexpr std::string_view kType = "image", kLabel = "Image", kTip = "Light from a panorama, .hdr or .exr.";

    std::string file;
    std::shared_ptr<const Image> image;
    float scale = 1;
    float rotation = 0;  ///< Degrees.

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.file, Field{"file", "File", "Equirectangular image, .hdr or .exr.", FieldRole::file});
        visit(self.scale, Field{.key = "scale",
                                .label = "Scale",
                                .tip = "Multiplies the image's light.",
                                .min = 0,
                                .soft_min = 0,
                                .soft_max = 4});
        visit(self.rotation, Field{.key = "rotation",
                                   .label = "Rotation",
                                   .tip = "Turns the panorama about the vertical.",
                                   .role = FieldRole::angle,
                                   .soft_min = -180,
                                   .soft_max = 180});
    }
    std::array<Color, 1> light() const { return {Color(scale)}; }
    void put_out() { scale = 0; }
    bool operator==(const ImageEnvironment&) const = default;
};

/// The list of environments.
using Environment = std::variant<NoEnvironment, ConstantEnvironment, GradientEnvironment, ImageEnvironment>;

}  // namespace rayuela
