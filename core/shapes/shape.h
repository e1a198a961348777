#pragma once

#include "core/shapes/box.h"
#include "core/shapes/gltf.h"
#include "core/shapes/mesh.h"
#include "core/shapes/object_list.h"
#include "core/shapes/plane.h"
#include "core/shapes/quad.h"
#include "core/shapes/sphere.h"
#include "core/shapes/triangle.h"

#include <variant>

namespace rayuela {

/// The list of shapes. A new one is a struct with kType, kLabel, kTip and visit_fields, added here; scene files, panels,
/// the "add" menu and the property tests loop over this list.
using Shape = std::variant<Sphere, Plane, Box, Triangle, Quad, ObjectList, Mesh, Gltf>;

}  // namespace rayuela
