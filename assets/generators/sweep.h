#pragma once

#include "core/shapes/mesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rayuela::assets {

/// One cross section of a limb: where it is, how thick, and which way its back faces.
struct Station {
    Vec3d center;
    double radius;
    Vec3d back{0, 1, 0};
};

inline Station operator*(double t, const Station& s) {
    return {t * s.center, t * s.radius, t * s.back};
}
inline Station operator+(const Station& a, const Station& b) {
    return {a.center + b.center, a.radius + b.radius, a.back + b.back};
}

/// A smooth tube through stations (Catmull-Rom), measured by its length.
class Tube {
public:
    explicit Tube(std::vector<Station> stations) : stations_(std::move(stations)) {
        constexpr int kSamplesPerStation = 64;
        const std::size_t samples = (stations_.size() - 1) * kSamplesPerStation + 1;
        for (std::size_t i = 0; i < samples; ++i) {
            samples_.push_back(interpolate(static_cast<double>(i) / kSamplesPerStation));
            const double step = i == 0 ? 0 : glm::distance(samples_[i].center, samples_[i - 1].center);
            lengths_.push_back(i == 0 ? 0 : lengths_.back() + step);
            girths_.push_back(i == 0 ? 0 : girths_.back() + step / std::max(samples_[i].radius, 0.02));
        }
    }

    double length() const { return lengths_.back(); }
    /// Integral of ds / radius up to `s`: counts pattern elements that shrink with the tube.
    double girths(double s) const { return mix(girths_, locate(s)); }

    struct Section {
        Vec3d center, forward, back, side;
        double radius;
        Vec3d direction(double angle) const { return std::cos(angle) * back + std::sin(angle) * side; }
    };

    /// The cross section at distance `s` from the start.
    Section at(double s) const {
        const double i = locate(s);
        const auto low = static_cast<std::size_t>(i);
        const Station station = (1 - (i - std::floor(i))) * samples_[low] + (i - std::floor(i)) * samples_[low + 1];
        const std::size_t before = low == 0 ? 0 : low - 1, after = std::min(low + 2, samples_.size() - 1);
        const Vec3d forward = glm::normalize(samples_[after].center - samples_[before].center);
        const Vec3d back = glm::normalize(station.back - forward * glm::dot(station.back, forward));
        return {station.center, forward, back, glm::cross(forward, back), std::max(station.radius, 0.0)};
    }

private:
    Station interpolate(double t) const {
        const auto last = static_cast<std::ptrdiff_t>(stations_.size()) - 1;
        const auto i = std::min(static_cast<std::ptrdiff_t>(t), last - 1);
        const auto station = [&](std::ptrdiff_t k) {
            return stations_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
        };
        const double x = t - static_cast<double>(i), xx = x * x, xxx = xx * x;
        return 0.5 * ((-x + 2 * xx - xxx) * station(i - 1) + (2 - 5 * xx + 3 * xxx) * station(i) +
                      (x + 4 * xx - 3 * xxx) * station(i + 1) + (xxx - xx) * station(i + 2));
    }

    /// Fractional index of the sample at distance `s`, below the last.
    double locate(double s) const {
        const auto above = std::upper_bound(lengths_.begin(), lengths_.end(), s);
        const std::ptrdiff_t high =
            std::clamp<std::ptrdiff_t>(above - lengths_.begin(), 1, static_cast<std::ptrdiff_t>(lengths_.size()) - 1);
        const double a = lengths_[static_cast<std::size_t>(high - 1)], b = lengths_[static_cast<std::size_t>(high)];
        const double fraction = std::clamp((s - a) / (b - a), 0.0, 1.0 - 1e-9);
        return static_cast<double>(high - 1) + fraction;
    }

    static double mix(const std::vector<double>& values, double i) {
        const auto low = static_cast<std::size_t>(i);
        return values[low] + (i - std::floor(i)) * (values[low + 1] - values[low]);
    }

    std::vector<Station> stations_, samples_;
    std::vector<double> lengths_, girths_;
};

/// Adds the closed skin of the tube to the mesh: `rings` rings of `sides` vertices and a pole at each end. `relief(s, angle)`
/// is how far the skin stands out, in radii; angle 0 is the back. Normals are left to be computed.
template <typename Relief>
void add_skin(TriangleMesh& mesh, const Tube& tube, int rings, int sides, const Relief& relief) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto add = [&](const Vec3d& p) { mesh.positions.push_back(Vec3(p)); };
    add(tube.at(0).center);
    for (int ring = 1; ring <= rings; ++ring) {
        const double s = tube.length() * ring / (rings + 1);
        const Tube::Section section = tube.at(s);
        for (int side = 0; side < sides; ++side) {
            const double angle = 2 * glm::pi<double>() * side / sides;
            add(section.center + section.direction(angle) * (section.radius * (1 + relief(s, angle))));
        }
    }
    add(tube.at(tube.length()).center);
    const auto vertex = [&](int ring, int side) {
        return first + 1 + static_cast<std::uint32_t>(ring * sides + side % sides);
    };
    const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    for (int side = 0; side < sides; ++side) {
        mesh.triangles.push_back({first, vertex(0, side + 1), vertex(0, side)});
        for (int ring = 0; ring + 1 < rings; ++ring) {
            mesh.triangles.push_back({vertex(ring, side), vertex(ring, side + 1), vertex(ring + 1, side)});
            mesh.triangles.push_back({vertex(ring, side + 1), vertex(ring + 1, side + 1), vertex(ring + 1, side)});
        }
        mesh.triangles.push_back({last, vertex(rings - 1, side), vertex(rings - 1, side + 1)});
    }
}

/// Normals as the mean of the faces around, weighted by area; bounds of the positions.
inline void finish(TriangleMesh& mesh) {
    std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0));
    for (const glm::uvec3& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const Vec3d normal = glm::cross(b - a, c - a);
        for (int i = 0; i < 3; ++i) sums[t[i]] += normal;
    }
    mesh.normals.clear();
    for (const Vec3d& sum : sums) {
        const double length = glm::length(sum);
        mesh.normals.push_back(length > 0 ? Vec3(sum / length) : Vec3(0, 1, 0));
    }
    for (const Vec3& p : mesh.positions) mesh.bounds.extend(p);
}

inline void append(TriangleMesh& mesh, const TriangleMesh& part) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    for (const glm::uvec3& t : part.triangles) mesh.triangles.push_back(t + first);
}

}  // namespace rayuela::assets
