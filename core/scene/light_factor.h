#pragma once

#include "core/scene/scene.h"

#include <optional>

namespace rayuela {

/// Of two scenes whose visible objects have the same shapes at the same places and the same material numbers: the factor,
/// channel by channel, by which the light of all sources has changed, so that the image has too. 1 in channels without
/// light. Nothing where sources have changed by different factors, where light has come into a channel, or where something
/// else that is seen has changed.
std::optional<Vec3d> light_factor(const Scene& before, const Scene& after);

}  // namespace rayuela
