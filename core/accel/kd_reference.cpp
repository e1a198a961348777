#include "core/accel/kd_reference.h"

#include "core/accel/traced_object.h"

#include <array>

namespace rayuela {
namespace {

Bounds3 intersection(const Bounds3& a, const Bounds3& b) {
    const Bounds3 both{glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
    return both.empty() ? Bounds3() : both;
}

/// Bounds of the two parts of a triangle.
KdSides clip_triangle(const std::array<Vec3, 3>& vertices, int axis, float plane) {
    KdSides sides;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &a = vertices[i], &b = vertices[(i + 1) % 3];
        if (a[axis] <= plane) sides.below.extend(a);
        if (a[axis] >= plane) sides.above.extend(a);
        if ((a[axis] < plane) == (b[axis] < plane) || a[axis] == plane || b[axis] == plane) continue;
        // From the lower end always, so that triangles which share the edge agree.
        const Vec3d from(a[axis] < b[axis] ? a : b), to(a[axis] < b[axis] ? b : a);
        const Vec3d crossing = from + (plane - from[axis]) / (to[axis] - from[axis]) * (to - from);
        Bounds3 point = round_outward(crossing, crossing);
        point.lo[axis] = point.hi[axis] = plane;
        sides.below.extend(point);
        sides.above.extend(point);
    }
    return sides;
}

}  // namespace

KdSides split_reference(const KdReference& reference, const TriangleMesh* mesh, int axis, float plane) {
    const Bounds3& box = reference.box;
    if (box.hi[axis] <= plane) return {box, {}};
    if (box.lo[axis] >= plane) return {{}, box};
    KdSides sides{box, box};
    sides.below.hi[axis] = plane;
    sides.above.lo[axis] = plane;
    if (!mesh) return sides;
    const glm::uvec3& t = mesh->triangles[reference.primitive];
    const KdSides clipped =
        clip_triangle({mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z]}, axis, plane);
    return {intersection(sides.below, clipped.below), intersection(sides.above, clipped.above)};
}

}  // namespace rayuela
