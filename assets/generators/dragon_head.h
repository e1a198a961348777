#pragma once

#include "assets/generators/implicit.h"
#include "assets/generators/polygonize.h"
#include "assets/generators/sweep.h"

#include <array>

namespace rayuela::assets {

/// The head in its own space: looks along +z, +y is up, the neck joins at the origin, the snout ends near z = 1.
inline double dragon_skull(const Vec3d& point) {
    const Vec3d p(std::abs(point.x), point.y, point.z);
    double d = ellipsoid(p, {0, 0.08, -0.02}, {0.3, 0.27, 0.42});
    d = smooth_union(d, round_cone(p * Vec3d(0.85, 1, 1), {0, 0.09, 0.2}, 0.21, {0, 0.06, 0.84}, 0.125), 0.12);
    d = smooth_union(d, ellipsoid(p, {0, 0.14, 0.9}, {0.15, 0.085, 0.11}), 0.06);                   // nose
    d = smooth_union(d, sphere(p, {0.09, 0.19, 0.93}, 0.055), 0.04);                                // nostril rim
    d = smooth_subtraction(d, sphere(p, {0.1, 0.2, 0.985}, 0.035), 0.02);                           // nostril
    d = smooth_union(d, round_cone(p, {0.1, 0.25, 0.46}, 0.05, {0.27, 0.34, 0.02}, 0.085), 0.06);   // brow
    d = smooth_subtraction(d, sphere(p, {0.27, 0.19, 0.34}, 0.11), 0.05);                           // socket
    d = smooth_union(d, sphere(p, {0.2, 0.19, 0.33}, 0.085), 0.012);                                // eyeball
    d = smooth_union(d, ellipsoid(p, {0.24, -0.06, 0.1}, {0.11, 0.17, 0.22}), 0.08);                // cheek
    d = smooth_union(d, round_cone(p, {0.13, -0.03, 0.8}, 0.035, {0.21, -0.02, 0.3}, 0.05), 0.03);  // upper lip
    const double jaw = round_cone(p * Vec3d(0.8, 1, 1), {0, -0.19, 0.02}, 0.15, {0, -0.42, 0.66}, 0.085);
    const double lip = round_cone(p, {0.1, -0.35, 0.66}, 0.035, {0.19, -0.13, 0.12}, 0.05);
    const double lower = smooth_union(jaw, lip, 0.05);
    const double tray = round_cone(p, {0, -0.04, 0.14}, 0.13, {0, -0.3, 0.62}, 0.065);
    d = smooth_union(d, smooth_subtraction(lower, tray, 0.03), 0.06);
    return smooth_union(d, round_cone(p, {0, 0, -0.1}, 0.28, {0, -0.04, -0.4}, 0.27), 0.15);  // nape
}

/// Pebbly hide: distance to the nearest of scattered points (Worley 1996), 0 at the point.
inline double pebbles(const Vec3d& p) {
    const glm::ivec3 cell(glm::floor(p));
    const auto scatter = [](glm::ivec3 c, std::uint32_t salt) {
        std::uint32_t h = salt + static_cast<std::uint32_t>(c.x) * 0x8da6b343u +
                          static_cast<std::uint32_t>(c.y) * 0xd8163841u + static_cast<std::uint32_t>(c.z) * 0xcb1ab31fu;
        h = (h ^ (h >> 15)) * 0x2c1b3c6du;
        h = (h ^ (h >> 12)) * 0x297a2d39u;
        return (h ^ (h >> 15)) * 0x1p-32;
    };
    double nearest = 4;
    for (int i = 0; i < 27; ++i) {
        const glm::ivec3 c = cell + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
        const Vec3d offset = Vec3d(c) + Vec3d(scatter(c, 1), scatter(c, 2), scatter(c, 3)) - p;
        nearest = std::min(nearest, glm::dot(offset, offset));
    }
    return std::sqrt(nearest);
}

inline TriangleMesh make_skull(double cell) {
    TriangleMesh mesh = polygonize(dragon_skull, {-0.5, -0.62, -0.75}, {0.5, 0.56, 1.12}, cell, 2);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3d p(mesh.positions[i]);
        const double eye = glm::distance(Vec3d(std::abs(p.x), p.y, p.z), {0.2, 0.19, 0.33});
        const double hide = std::clamp((eye - 0.1) / 0.05, 0.0, 1.0);
        const double bump = std::max(0.0, 0.55 - pebbles(p * 17.0));
        mesh.positions[i] += mesh.normals[i] * static_cast<float>(0.035 * hide * bump);
    }
    return mesh;
}

/// Horns, teeth, mane, whiskers and tongue: tubes that grow out of the skull, for the side x > 0 (`side` 1) or x < 0 (-1).
inline std::vector<Tube> head_ornaments(double side) {
    const auto tube = [&](std::vector<Station> stations) {
        for (Station& s : stations) s.center.x *= side;
        return Tube(std::move(stations));
    };
    std::vector<Tube> tubes;
    // Antlers: a beam and two tines.
    tubes.push_back(tube({{{0.12, 0.26, -0.02}, 0.075},
                          {{0.2, 0.52, -0.22}, 0.062},
                          {{0.3, 0.74, -0.55}, 0.05},
                          {{0.34, 0.98, -0.86}, 0.034},
                          {{0.3, 1.22, -1.02}, 0.0}}));
    tubes.push_back(tube({{{0.22, 0.58, -0.3}, 0.045}, {{0.34, 0.74, -0.26}, 0.036}, {{0.42, 0.92, -0.3}, 0.0}}));
    tubes.push_back(tube({{{0.31, 0.8, -0.64}, 0.036}, {{0.44, 0.88, -0.78}, 0.028}, {{0.56, 1.0, -0.86}, 0.0}}));
    // Ears.
    tubes.push_back(tube({{{0.24, 0.14, -0.12}, 0.07}, {{0.42, 0.22, -0.3}, 0.075}, {{0.6, 0.24, -0.52}, 0.0}}));
    // Mane: locks that stream back around the cheek.
    constexpr int kLocks = 9;
    for (int i = 0; i < kLocks; ++i) {
        const double turn = 0.35 + 2.35 * i / (kLocks - 1), c = std::cos(turn), s = std::sin(turn),
                     wave = i % 2 == 0 ? 0.06 : -0.04;
        tubes.push_back(tube({{{0.22 * s, 0.02 + 0.22 * c, -0.1}, 0.06},
                              {{0.42 * s, 0.02 + 0.4 * c, -0.36}, 0.065},
                              {{0.52 * s, 0.04 + 0.52 * c + wave, -0.66}, 0.045},
                              {{0.62 * s, 0.06 + 0.62 * c, -0.92 - wave}, 0.0}}));
    }
    // Whisker.
    tubes.push_back(tube({{{0.13, 0.06, 0.88}, 0.03},
                          {{0.34, 0.02, 1.04}, 0.026},
                          {{0.58, 0.2, 0.98}, 0.022},
                          {{0.72, 0.46, 0.7}, 0.018},
                          {{0.96, 0.52, 0.46}, 0.013},
                          {{1.14, 0.36, 0.34}, 0.0}}));
    // Beard.
    for (int i = 0; i < 3; ++i) {
        const double z = 0.52 - 0.17 * i, y = -0.46 + 0.06 * i, x = 0.05 + 0.025 * i;
        tubes.push_back(
            tube({{{x, y, z}, 0.035}, {{x + 0.03, y - 0.14, z - 0.03}, 0.032}, {{x + 0.02, y - 0.3, z - 0.16}, 0.0}}));
    }
    // Fangs and teeth, above and below.
    for (int i = 0; i < 6; ++i) {
        const double z = 0.84 - 0.1 * i, x = 0.105 + 0.018 * i, size = i == 0 ? 1.7 : 1.0;
        tubes.push_back(tube({{{x, -0.02, z}, 0.026 * size},
                              {{x, -0.075 * size, z - 0.005}, 0.017 * size},
                              {{x, -0.125 * size, z - 0.015}, 0.0}}));
        const double low = -0.345 + 0.042 * i, jz = 0.68 - 0.1 * i;
        tubes.push_back(tube({{{x - 0.01, low, jz}, 0.024 * size},
                              {{x - 0.01, low + 0.055 * size, jz + 0.015}, 0.016 * size},
                              {{x - 0.01, low + 0.1 * size, jz + 0.02}, 0.0}}));
    }
    return tubes;
}

inline Tube dragon_tongue() {
    return Tube({{{0, -0.12, 0.1}, 0.07},
                 {{0, -0.22, 0.42}, 0.065},
                 {{0.01, -0.24, 0.72}, 0.05},
                 {{0.02, -0.2, 0.92}, 0.035},
                 {{0.02, -0.1, 1.06}, 0.0}});
}

}  // namespace rayuela::assets
