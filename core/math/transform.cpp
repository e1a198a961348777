#include "core/math/transform.h"

#include <cmath>

namespace rayuela {

Affine Affine::inverse() const {
    const glm::dmat3 inverse_linear = glm::inverse(glm::dmat3(linear));
    return {Mat3(inverse_linear), Vec3(-(inverse_linear * Vec3d(translation)))};
}

bool Affine::is_invertible() const {
    const double determinant = glm::determinant(glm::dmat3(linear));
    return std::isfinite(determinant) && determinant != 0 && is_finite(translation);
}

Bounds3 Affine::bounds(const Bounds3& box) const {
    Bounds3 result;
    if (box.empty()) return result;
    for (int corner = 0; corner < 8; ++corner) {
        result.extend(point({(corner & 1) ? box.hi.x : box.lo.x, (corner & 2) ? box.hi.y : box.lo.y,
                             (corner & 4) ? box.hi.z : box.lo.z}));
    }
    return result;
}

Affine Transform::affine() const {
    if (matrix) return {Mat3(*matrix), Vec3((*matrix)[3])};
    const Mat3 rotation = glm::mat3_cast(rotate);
    return {Mat3(rotation[0] * scale.x, rotation[1] * scale.y, rotation[2] * scale.z), translate};
}

}  // namespace rayuela
