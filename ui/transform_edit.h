#pragma once

#include "core/math/transform.h"

#include <optional>

namespace rayuela {

/// Translation, rotation and scale whose affine is `affine` but for rounding; nothing where it shears.
std::optional<Transform> decomposed(const Affine& affine);
/// The same where possible, else the matrix.
Transform transform_from(const Affine& affine);

/// Rotation about x, then y, then z (fixed axes), in degrees, and back.
Quat rotation_from_degrees(const Vec3& degrees);
Vec3 degrees_from_rotation(const Quat& rotation);

}  // namespace rayuela
