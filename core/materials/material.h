#pragma once

#include "core/materials/dielectric.h"
#include "core/materials/diffuse.h"
#include "core/materials/emitter.h"
#include "core/materials/metal.h"
#include "core/materials/principled.h"

#include <variant>

namespace rayuela {

/// The list of materials. A new one is a file with its struct (kType, kLabel, kTip, visit_fields) and its Bsdf, added
/// here; scene files, panels, the command line and the property tests loop over this list and its fields.
using Material = std::variant<Diffuse, Metal, Dielectric, Emitter, Principled>;

}  // namespace rayuela
