#pragma once

#include "core/lights/environment_light.h"
#include "core/lights/light_sample.h"
#include "core/math/distribution.h"

#include <optional>

namespace rayuela {

/// Draws directions in proportion to the brightness of an environment image: constant over each cell of an equirectangular
/// grid (a pixel, or a few of a large image), uniform per solid angle within a cell.
class EnvironmentDistribution {
public:
    /// `light` must have an image that is not empty.
    explicit EnvironmentDistribution(const EnvironmentLight& light);

    /// Whether the image is black, so that nothing can be drawn.
    bool empty() const { return cells_.total() == 0; }
    std::optional<LightSample> sample(const Vec2& u) const;
    float pdf(const Vec3& wi) const;
    std::uint64_t memory_bytes() const { return cells_.memory_bytes(); }

private:
    /// Of a cell along one axis of the image, in [0, 1].
    struct Extent {
        double begin, end;
    };
    Extent extent(std::uint32_t cell, int pixels) const;
    float solid_angle(std::uint32_t column, std::uint32_t row) const;

    EnvironmentLight light_;
    Distribution2D cells_;
    int pixels_per_cell_ = 1;
};

}  // namespace rayuela
