#pragma once

#include "core/math/vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace rayuela::test {

/// The sphere of directions in cells that a first lot of directions decides: about the same number in each, so that
/// lobes of any width are resolved. The horizon z = 0 is always a border.
class DirectionHistogram {
public:
    DirectionHistogram(const std::vector<Vec3>& pilot, std::size_t per_cell)
        : per_cell_(per_cell), pilot_(static_cast<double>(pilot.size())) {
        std::vector<Polar> upper, lower;
        for (const Vec3& w : pilot) (w.z >= 0 ? upper : lower).push_back(polar(w));
        const double pi = std::numbers::pi;
        root_[0] = build({{0, pi / 2}, {-pi, pi}}, upper, 0);
        root_[1] = build({{pi / 2, pi}, {-pi, pi}}, lower, 0);
    }

    std::size_t size() const { return cells_.size(); }

    std::size_t cell(const Vec3& w) const {
        const Polar p = polar(w);
        int node = root_[w.z >= 0 ? 0 : 1];
        while (nodes_[node].axis >= 0) node = nodes_[node].child[p[nodes_[node].axis] >= nodes_[node].split];
        return static_cast<std::size_t>(nodes_[node].cell);
    }

    /// Integral of a density per solid angle over a cell, to about `tolerance`.
    double integrate(std::size_t cell, const std::function<double(const Vec3&)>& pdf, double tolerance) const {
        double sum = 0;
        for (const Patch& patch : cells_[cell]) {
            double part = integrate(patch, pdf, tolerance, 0);
            // So much less than the pilot found there: the peak of a narrow lobe lies between the abscissas.
            if (part < 0.2 * patch.share) part = integrate(patch, pdf, tolerance, 3);
            sum += part;
        }
        return sum;
    }

private:
    using Polar = std::array<double, 2>;  // theta, phi
    struct Interval {
        double lo, hi;
        double at(double t) const { return lo + t * (hi - lo); }
        double size() const { return hi - lo; }
    };
    struct Rect {
        Interval theta, phi;
    };
    /// A part of a cell to be integrated at once, with where most of the few directions of the pilot in it lie.
    struct Patch : Rect {
        Interval points_theta, points_phi;
        double share;  ///< Of the pilot's directions.
    };
    struct Node {
        int axis = -1;
        double split = 0;
        std::array<int, 2> child{};
        int cell = 0;
    };
    static constexpr std::size_t kPerPatch = 8;

    static Polar polar(const Vec3& w) {
        return {std::atan2(std::hypot(double(w.x), double(w.y)), double(w.z)), std::atan2(double(w.y), double(w.x))};
    }

    static double integrate(const Patch& patch, const std::function<double(const Vec3&)>& pdf, double tolerance,
                            int min_depth) {
        const std::vector<double> thetas = graded(patch.theta, patch.points_theta);
        const std::vector<double> phis = graded(patch.phi, patch.points_phi);
        double sum = 0;
        for (std::size_t i = 0; i + 1 < thetas.size(); ++i) {
            for (std::size_t j = 0; j + 1 < phis.size(); ++j) {
                const Rect r{{thetas[i], thetas[i + 1]}, {phis[j], phis[j + 1]}};
                sum += adaptive(r, pdf, gauss(r, pdf), tolerance, min_depth, 0);
            }
        }
        return sum;
    }

    static Interval& side(Rect& r, int axis) { return axis == 0 ? r.theta : r.phi; }

    int build(const Rect& r, std::vector<Polar>& points, int depth) {
        const int index = static_cast<int>(nodes_.size());
        nodes_.emplace_back();
        if (points.size() < 2 * per_cell_) {
            nodes_[index].cell = static_cast<int>(cells_.size());
            cells_.emplace_back();
            add_patches(r, points, depth);
            return index;
        }
        std::array<Rect, 2> rects{r, r};
        std::array<std::vector<Polar>, 2> parts;
        const double split = cut(points, depth % 2, rects, parts);
        const int first = build(rects[0], parts[0], depth + 1), second = build(rects[1], parts[1], depth + 1);
        nodes_[index] = {depth % 2, split, {first, second}, 0};
        return index;
    }

    void add_patches(const Rect& r, std::vector<Polar>& points, int depth) {
        if (points.size() < 2 * kPerPatch) {
            cells_.back().push_back(
                {r, core(points, 0, r.theta), core(points, 1, r.phi), static_cast<double>(points.size()) / pilot_});
            return;
        }
        std::array<Rect, 2> rects{r, r};
        std::array<std::vector<Polar>, 2> parts;
        cut(points, depth % 2, rects, parts);
        for (int i = 0; i < 2; ++i) add_patches(rects[i], parts[i], depth + 1);
    }

    /// At the median.
    static double cut(std::vector<Polar>& points, int axis, std::array<Rect, 2>& rects,
                      std::array<std::vector<Polar>, 2>& parts) {
        const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
        std::ranges::nth_element(points, middle, {}, [axis](const Polar& p) { return p[axis]; });
        const double split = (*middle)[axis];
        for (const Polar& p : points) parts[p[axis] >= split].push_back(p);
        side(rects[0], axis).hi = side(rects[1], axis).lo = split;
        return split;
    }

    /// The shortest interval that has more than half of the points: where a narrow lobe reaches into a wide one, the others
    /// may lie anywhere.
    static Interval core(const std::vector<Polar>& points, int axis, const Interval& all) {
        if (points.size() < 2) return all;
        std::vector<double> sorted;
        for (const Polar& p : points) sorted.push_back(p[axis]);
        std::ranges::sort(sorted);
        const std::size_t span = points.size() / 2;
        Interval shortest{sorted.front(), sorted.back()};
        for (std::size_t i = 0; i + span < sorted.size(); ++i) {
            const Interval part{sorted[i], sorted[i + span]};
            if (part.size() < shortest.size()) shortest = part;
        }
        return shortest;
    }

    /// Breaks of `all`: where the points lie, and in growing steps from there, as the tails of a lobe want it.
    static std::vector<double> graded(const Interval& all, const Interval& points) {
        std::vector<double> breaks{all.lo, all.hi};
        const double width = std::max(points.size(), 1e-7);
        if (width > 0.25 * all.size()) return breaks;
        for (double step = 0; points.lo - step > all.lo; step = 4 * step + width) breaks.push_back(points.lo - step);
        for (double step = 0; points.hi + step < all.hi; step = 4 * step + width) breaks.push_back(points.hi + step);
        std::ranges::sort(breaks);
        return breaks;
    }

    /// Gauss-Legendre, 3 x 3 points.
    static double gauss(const Rect& r, const std::function<double(const Vec3&)>& pdf) {
        constexpr std::array<double, 3> t{0.1127016653792583, 0.5, 0.8872983346207417};
        constexpr std::array<double, 3> weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            const double theta = r.theta.at(t[i]), sine = std::sin(theta), cosine = std::cos(theta);
            for (int j = 0; j < 3; ++j) {
                const double phi = r.phi.at(t[j]);
                const Vec3 w(glm::dvec3(sine * std::cos(phi), sine * std::sin(phi), cosine));
                sum += weight[i] * weight[j] * pdf(w) * sine;
            }
        }
        return sum * r.theta.size() * r.phi.size();
    }

    static double adaptive(const Rect& r, const std::function<double(const Vec3&)>& pdf, double whole, double tolerance,
                           int min_depth, int depth) {
        std::array<Rect, 4> quarters;
        std::array<double, 4> parts;
        double sum = 0;
        for (int i = 0; i < 4; ++i) {
            const double t = 0.5 * (i & 1), p = 0.5 * (i >> 1);
            quarters[i] = {{r.theta.at(t), r.theta.at(t + 0.5)}, {r.phi.at(p), r.phi.at(p + 0.5)}};
            sum += parts[i] = gauss(quarters[i], pdf);
        }
        if (depth >= 10 || (depth >= min_depth && std::abs(sum - whole) <= tolerance)) return sum;
        sum = 0;
        for (int i = 0; i < 4; ++i) sum += adaptive(quarters[i], pdf, parts[i], 0.5 * tolerance, min_depth, depth + 1);
        return sum;
    }

    std::size_t per_cell_;
    double pilot_;  ///< Directions in it.
    std::vector<Node> nodes_;
    std::vector<std::vector<Patch>> cells_;
    std::array<int, 2> root_{};
};

}  // namespace rayuela::test
