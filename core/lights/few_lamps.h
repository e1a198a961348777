#pragma once

#include "core/lights/area_light.h"
#include "core/lights/light_block.h"
#include "core/lights/light_tree.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace rayuela {

/// Lamps so few that many points choose among them at once: what LightTable::sample does, the same to the last bit.
class FewLamps {
public:
    static constexpr std::size_t kMost = 8;
    using Row = std::array<float, kMost>;
    using Rows = std::array<Row, 3>;

    /// Nothing where there are more, or where one is textured.
    static std::optional<FewLamps> of(std::span<const AreaLight> lights, const LightTree& tree);

    /// Fills what is to be found.
    void sample(LightBlock& block) const;

    std::size_t count = 0;
    bool any_sphere = false, any_flat = false, any_triangle = false;

    LightClusters clusters;  ///< One lamp a lane. Unused where there is but one.

    /// As in AreaLight.
    Rows origin{}, edge_u{}, edge_v{}, diagonal{}, normal{}, radiance{}, point_error{};
    Row size{}, area{}, near2{}, close2{};
    Rows frame_x{}, frame_y{}, frame_z{};  ///< As in RectangleFrame.
    Row frame_width{}, frame_height{};
    Row is_sphere{}, is_triangle{}, two_sided{};  ///< 1 or 0.

private:
    void add(const AreaLight& light);
};

}  // namespace rayuela
