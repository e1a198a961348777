#pragma once

#include "assets/generators/dragon_head.h"

namespace rayuela::assets {

/// From the tip of the tail around the coil and up the neck.
inline std::vector<Station> body_stations() {
    std::vector<Station> stations;
    const auto coil = [&](double degrees, double distance, double height, double radius) {
        const double a = glm::radians(degrees);
        const Vec3d outward(std::sin(a), 0, std::cos(a));
        stations.push_back(
            {outward * distance + Vec3d(0, height, 0), radius, glm::normalize(outward * 0.5 + Vec3d(0, 1, 0))});
    };
    coil(-78, 3.0, 0.62, 0.0);
    coil(-62, 2.75, 0.3, 0.075);
    coil(-40, 2.45, 0.13, 0.12);
    coil(-12, 2.2, 0.17, 0.16);
    coil(20, 2.05, 0.22, 0.21);
    coil(55, 1.95, 0.27, 0.26);
    coil(92, 1.88, 0.32, 0.31);
    coil(130, 1.82, 0.36, 0.35);
    coil(168, 1.76, 0.4, 0.39);
    coil(206, 1.68, 0.43, 0.42);
    coil(244, 1.58, 0.47, 0.44);
    coil(282, 1.42, 0.53, 0.45);
    coil(320, 1.22, 0.68, 0.45);
    coil(362, 1.02, 0.94, 0.44);
    coil(410, 0.88, 1.22, 0.43);
    coil(462, 0.76, 1.5, 0.41);
    stations.push_back({{0.34, 1.78, -0.72}, 0.39, {0.25, 0.55, -0.8}});
    stations.push_back({{-0.28, 2.08, -0.66}, 0.365, {-0.4, 0.2, -0.9}});
    stations.push_back({{-0.48, 2.48, -0.28}, 0.335, {-0.3, 0.1, -1}});
    stations.push_back({{-0.26, 2.92, -0.12}, 0.305, {0, 0.2, -1}});
    stations.push_back({{0.02, 3.26, 0.02}, 0.285, {0, 0.75, -0.7}});
    stations.push_back({{0.12, 3.42, 0.42}, 0.27, {0, 1, -0.1}});
    stations.push_back({{0.14, 3.38, 0.75}, 0.2, {0, 1, 0.1}});
    return stations;
}

/// Overlapping scales, `around` of them in a circle. `along` counts radii from the head. In radii.
inline double scale_relief(double along, double turn, int around) {
    const double rows = 0.75 * along * around / (2 * glm::pi<double>());
    double height = 0;
    for (int back = 0; back < 2; ++back) {
        const double row = std::floor(rows) - back;
        const double down = rows - row;  // 0 at the root of the scale, 1.7 at its free end
        const bool shifted = std::fmod(row, 2) != 0;
        const double column = turn * around + (shifted ? 0.5 : 0);
        const double across = column - std::floor(column) - 0.5;
        const double tip = std::max(0.0, down - 0.75) / 0.95;
        if (3.6 * across * across + tip * tip > 1) continue;
        const double keel = std::max(0.0, 1 - 6 * std::abs(across));
        height = std::max(height, (0.025 + 0.044 * down) * (1 - 1.6 * across * across + 0.12 * keel));
    }
    return height;
}

/// Broad plates across the belly, `belly` of a turn wide to both sides; elsewhere scales.
inline double hide_relief(double along, double angle, int around, double belly) {
    const double turn = angle / (2 * glm::pi<double>());  // 0 at the back, 1/2 at the belly
    const double inside = belly - std::abs(turn - 0.5);
    if (inside < 0) return scale_relief(along, turn, around);
    const double plates = 0.075 * along * around;
    return 0.02 + 0.055 * (plates - std::floor(plates)) * std::min(1.0, 40 * inside);
}

inline void add_scaled(TriangleMesh& mesh, const Tube& tube, double budget, int around, double belly) {
    const int sides = std::max(8, static_cast<int>(std::sqrt(0.07 * budget)));
    const int rings = std::max(8, static_cast<int>(std::ceil(0.5 * budget / sides)));
    // Scales overlap towards the tail, which is where the tube starts.
    const double end = tube.girths(tube.length());
    add_skin(mesh, tube, rings, sides,
             [&](double s, double angle) { return hide_relief(end - tube.girths(s), angle, around, belly); });
}

inline void add_plain(TriangleMesh& mesh, const Tube& tube, double budget) {
    const int sides = std::max(6, static_cast<int>(std::sqrt(0.3 * budget)));
    const int rings = std::max(5, static_cast<int>(std::ceil(0.5 * budget / sides)));
    add_skin(mesh, tube, rings, sides, [](double, double) { return 0.0; });
}

/// Spines along the back, from the tail to the nape.
inline std::vector<Tube> crest_of(const Tube& body) {
    std::vector<Tube> spines;
    double s = 0.5;
    while (s < body.length() - 0.55) {
        const Tube::Section section = body.at(s);
        const double size = 0.13 + 0.42 * section.radius;
        const Vec3d root = section.center + section.back * (section.radius * 0.92);
        const Vec3d lean = section.back - 0.55 * section.forward;
        spines.push_back(Tube({{root, size * 0.24, section.side},
                               {root + size * 0.45 * section.back, size * 0.19, section.side},
                               {root + size * 0.95 * lean, 0, section.side}}));
        s += 0.1 + 0.32 * section.radius;
    }
    return spines;
}

struct Leg {
    Vec3d shoulder, elbow, wrist, grip;  ///< `grip` is where the toes point.
};

inline std::vector<Leg> legs() {
    return {{{0.05, 1.95, -0.55}, {0.95, 1.95, -0.1}, {1.02, 1.72, 0.75}, {0.1, -0.25, 0.6}},
            {{-0.45, 2.2, -0.5}, {-1.2, 2.25, -0.15}, {-1.25, 2.42, 0.62}, {0.1, 0.55, 0.75}},
            {{1.5, 0.5, -0.85}, {2.35, 0.75, -0.55}, {2.45, 0.16, 0.1}, {0.15, -0.12, 0.9}},
            {{-1.45, 0.55, 0.35}, {-2.2, 0.85, 0.6}, {-2.15, 0.16, 1.25}, {-0.15, -0.12, 0.9}}};
}

inline std::vector<Tube> limbs() {
    std::vector<Tube> tubes;
    for (const Leg& leg : legs()) {
        tubes.push_back(Tube({{leg.shoulder, 0.3},
                              {glm::mix(leg.shoulder, leg.elbow, 0.5), 0.25},
                              {leg.elbow, 0.17},
                              {glm::mix(leg.elbow, leg.wrist, 0.55), 0.15},
                              {leg.wrist, 0.11},
                              {leg.wrist + 0.16 * leg.grip, 0.0}}));
    }
    return tubes;
}

/// Four toes a foot, each ending in a claw.
inline std::vector<Tube> claws() {
    std::vector<Tube> tubes;
    for (const Leg& leg : legs()) {
        const Vec3d forward = glm::normalize(leg.grip);
        const Vec3d side = glm::normalize(glm::cross(Vec3d(0, 1, 0), forward)), up = glm::cross(forward, side);
        for (int toe = 0; toe < 4; ++toe) {
            const double spread = toe == 3 ? 0 : (toe - 1) * 0.75, reach = toe == 3 ? -0.75 : 1;
            const Vec3d out = glm::normalize(forward * reach + side * spread);
            const Vec3d knuckle = leg.wrist + 0.2 * out + 0.09 * up, ball = leg.wrist + 0.36 * out - 0.02 * up;
            tubes.push_back(Tube({{leg.wrist, 0.08},
                                  {knuckle, 0.068},
                                  {ball, 0.055},
                                  {ball + 0.12 * out + 0.02 * up, 0.04},
                                  {ball + 0.24 * out - 0.12 * up, 0.0}}));
        }
    }
    return tubes;
}

inline void add_head(TriangleMesh& mesh, double budget) {
    // Measured: the skull takes about 47 / cell^2 triangles.
    TriangleMesh head = make_skull(std::sqrt(47 / (budget * 0.75)));
    std::vector<Tube> ornaments = {dragon_tongue()};
    for (const double side : {1.0, -1.0}) {
        for (Tube& tube : head_ornaments(side)) ornaments.push_back(std::move(tube));
    }
    double total = 0;
    for (const Tube& tube : ornaments) total += tube.length();
    for (const Tube& tube : ornaments) add_plain(head, tube, budget * 0.25 * tube.length() / total);

    const double tilt = glm::radians(14.0), turn = glm::radians(16.0), scale = 1.15;
    const Vec3d forward(std::sin(turn) * std::cos(tilt), -std::sin(tilt), std::cos(turn) * std::cos(tilt));
    const Vec3d right = glm::normalize(glm::cross(Vec3d(0, 1, 0), forward)), up = glm::cross(forward, right);
    const Vec3d origin(0.15, 3.36, 0.82);
    for (Vec3& p : head.positions)
        p = Vec3(origin + scale * (double(p.x) * right + double(p.y) * up + double(p.z) * forward));
    append(mesh, head);
}

/// A coiled dragon, about 3.6 high, resting on y = 0 and looking towards +z.
/// A coiled dragon of at least `triangles` triangles, about 4.8 high, resting on y = 0 and looking towards +z. Parts cross
/// each other; each is closed.
inline TriangleMesh make_dragon(std::size_t triangles) {
    const double budget = static_cast<double>(triangles);
    TriangleMesh mesh;
    add_head(mesh, budget * 0.16);
    const Tube body(body_stations());
    const std::vector<Tube> crest = crest_of(body);
    for (const Tube& spine : crest) add_plain(mesh, spine, budget * 0.07 / static_cast<double>(crest.size()));
    for (const Tube& limb : limbs()) add_scaled(mesh, limb, budget * 0.02, 20, 0);
    const std::vector<Tube> all_claws = claws();
    for (const Tube& claw : all_claws) add_plain(mesh, claw, budget * 0.04 / static_cast<double>(all_claws.size()));
    add_scaled(mesh, body, std::max(budget - static_cast<double>(mesh.triangles.size()), 1000.0), 26, 0.13);
    finish(mesh);
    return mesh;
}

}  // namespace rayuela::assets
