#pragma once

#include "assets/generators/implicit.h"
#include "assets/generators/polygonize.h"

#include <string_view>

namespace rayuela::assets {

/// First line of the files.
inline constexpr std::string_view kDuckComment = "Rubber duck of Rayuela, written by assets/generators/duck.cpp";

/// A rubber duck, about 1.35 high, sitting on y = 0 and looking towards +z. Its sides mirror each other.
inline double duck_body(const Vec3d& point) {
    const Vec3d p(std::abs(point.x), point.y, point.z);
    double d = ellipsoid(p, {0, 0.42, -0.06}, {0.5, 0.52, 0.62});
    d = smooth_union(d, sphere(p, {0, 0.44, 0.2}, 0.41), 0.2);
    d = smooth_union(d, round_cone(p * Vec3d(0.62, 1, 1), {0, 0.52, -0.46}, 0.2, {0, 0.83, -0.83}, 0.045), 0.22);
    const Vec3d wing = pitched(p, {0.44, 0.5, -0.1}, 0.92, -0.39191835884530846);
    const double feathers = ellipsoid(wing, {0.47, 0.5, -0.1}, {0.1, 0.2, 0.36});
    const double wing_tip = round_cone(p, {0.47, 0.56, -0.3}, 0.1, {0.53, 0.74, -0.52}, 0.05);
    d = smooth_union(d, smooth_union(feathers, wing_tip, 0.12), 0.035);
    d = smooth_union(d, sphere(p, {0, 1.0, 0.3}, 0.365), 0.14);
    return smooth_intersection(d, -p.y, 0.08);
}

/// Two broad, upturned halves with a groove between them.
inline double duck_bill(const Vec3d& point) {
    const Vec3d p(std::abs(point.x), point.y, point.z);
    const double z = p.z - 0.6;
    const Vec3d bent(p.x, p.y - 0.55 * z * z, p.z);
    const double upper = ellipsoid(bent, {0, 0.955, 0.68}, {0.185, 0.062, 0.2});
    const double lower = ellipsoid(bent, {0, 0.885, 0.645}, {0.14, 0.05, 0.16});
    return smooth_union(upper, lower, 0.03);
}

inline TriangleMesh make_duck_body() {
    return polygonize(duck_body, {-0.75, -0.1, -1.1}, {0.75, 1.5, 0.8}, 0.068);
}

inline TriangleMesh make_duck_bill() {
    return polygonize(duck_bill, {-0.25, 0.75, 0.4}, {0.25, 1.15, 1.0}, 0.038);
}

}  // namespace rayuela::assets
