#pragma once

#include "core/accel/accelerator.h"
#include "core/lights/area_light.h"

#include <vector>

namespace rayuela {

/// Appends what `instance` emits where its material is emissive: one light a primitive, in the order of Hit::primitive,
/// those without area or light included; nothing for what cannot be sampled (planes, ellipsoids). Places, fronts and
/// texture coordinates are those of `surface_point`.
void append_lights(const GeometryInstance& instance, const Material& material, std::vector<AreaLight>& lights);

}  // namespace rayuela
