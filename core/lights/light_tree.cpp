#include "core/lights/light_tree.h"

#include "core/accel/parallel.h"
#include "core/math/bounds.h"
#include "core/math/float_error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

/// Unit directions within `spread` (an angle, at most pi) of `axis`.
struct NormalCone {
    Vec3d axis{0, 0, 1};
    double spread = -1;  ///< Negative: none.
};

NormalCone join(const NormalCone& a, const NormalCone& b) {
    if (a.spread < b.spread) return join(b, a);
    if (b.spread < 0) return a;
    const double between = std::acos(glm::clamp(glm::dot(a.axis, b.axis), -1.0, 1.0));
    if (std::min(between + b.spread, std::numbers::pi) <= a.spread) return a;
    const double spread = (a.spread + between + b.spread) / 2;
    const Vec3d across = b.axis - glm::dot(a.axis, b.axis) * a.axis;
    const double length = glm::length(across);
    if (spread >= std::numbers::pi || !(length > 0)) return {a.axis, std::numbers::pi};
    const double turn = spread - a.spread;
    return {glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * across / length), spread};
}

/// Directions into which surfaces with these normals shine, weighed: M_Omega of Conty Estevez & Kulla, eq. 1.
double orientation_measure(double spread) {
    const double reach = std::min(spread + std::numbers::pi / 2, std::numbers::pi);
    return 2 * std::numbers::pi * (1 - std::cos(spread)) +
           std::numbers::pi / 2 *
               (2 * reach * std::sin(spread) - std::cos(spread - 2 * reach) - 2 * spread * std::sin(spread) +
                std::cos(spread));
}

/// Side by side in parts: one addition need not wait for the one before.
float sum(const LightClusters::Lanes<float>& x) {
    constexpr std::size_t kParts = 8;
    std::array<float, kParts> parts{};
    for (std::size_t i = 0; i < x.size(); i += kParts) {
        for (std::size_t k = 0; k < kParts; ++k) parts[k] += x[i + k];
    }
    return ((parts[0] + parts[1]) + (parts[2] + parts[3])) + ((parts[4] + parts[5]) + (parts[6] + parts[7]));
}

Bounds3 bounds_of(const AreaLight& light) {
    Bounds3 bounds;
    if (light.kind == AreaLight::Kind::sphere) {
        bounds.extend(light.origin - light.size);
        bounds.extend(light.origin + light.size);
        return bounds;
    }
    bounds.extend(light.origin);
    bounds.extend(light.origin + light.edge_u);
    bounds.extend(light.origin + light.edge_v);
    if (light.kind == AreaLight::Kind::parallelogram) bounds.extend(light.origin + light.edge_u + light.edge_v);
    return bounds;
}

}  // namespace

/// Lights together, while the tree is built.
struct LightTree::Cluster {
    Bounds3 bounds;
    NormalCone normals;
    double power = 0;
    bool two_sided = false;
    std::uint32_t light = kNone;

    void add(const Cluster& other) {
        bounds.extend(other.bounds);
        normals = join(normals, other.normals);
        power += other.power;
        two_sided |= other.two_sided;
    }
    double cost() const { return power * orientation_measure(normals.spread) * double{bounds.surface_area()}; }
};

struct LightTree::Builder {
    static constexpr int kBins = 12;
    static constexpr std::size_t kParallelLights = 1024;

    std::vector<Node>& nodes;
    std::vector<Place>& places;
    double total_power;
    std::atomic<std::uint32_t> node_count{0};

    /// Makes a node for two lights or more; returns its index.
    std::uint32_t build(std::span<Cluster> lights) {
        const std::uint32_t index = node_count++;
        Node& node = nodes[index];
        node.clusters.radius2.fill(1);  // no 0 / 0 where there is no child
        const std::vector<std::span<Cluster>> parts = children(lights);
        const auto build_child = [&](std::size_t lane) {
            const Cluster all = join_all(parts[lane]);
            set_lane(node.clusters, lane, all);
            if (all.light != kNone) {
                places[all.light] = {index, static_cast<std::uint32_t>(lane)};
                node.child[lane] = all.light + kLeaf;
                return;
            }
            const std::uint32_t child = node.child[lane] = build(parts[lane]);
            nodes[child].parent = index;
            nodes[child].lane_of_parent = static_cast<std::uint32_t>(lane);
        };
        parallel_ranges(parts.size(), lights.size() < kParallelLights ? kClusters : 1,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t lane = begin; lane < end; ++lane) build_child(lane);
                        });
        return index;
    }

    static Cluster join_all(std::span<const Cluster> lights) {
        Cluster all = lights[0];
        for (const Cluster& light : lights.subspan(1)) all.add(light);
        if (lights.size() > 1) all.light = kNone;
        return all;
    }

    void set_lane(LightClusters& to, std::size_t lane, const Cluster& all) const {
        const Vec3 center = all.bounds.center(), half = 0.5f * all.bounds.hi - 0.5f * all.bounds.lo;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto component = static_cast<Vec3::length_type>(axis);
            to.center[axis][lane] = center[component];
            to.axis[axis][lane] = static_cast<float>(all.normals.axis[component]);
        }
        to.radius2[lane] = glm::dot(half, half);
        to.power[lane] = static_cast<float>(all.power / total_power);
        to.cos_spread[lane] = static_cast<float>(std::cos(all.normals.spread));
        to.sin_spread[lane] = static_cast<float>(std::sin(all.normals.spread));
        to.two_sided[lane] = all.two_sided ? LightClusters::kTwoSided : 0u;
    }

    /// Cuts the lights in two, and the costliest part again, until there is one for each lane.
    static std::vector<std::span<Cluster>> children(std::span<Cluster> lights) {
        std::vector<std::span<Cluster>> parts{lights};
        while (parts.size() < kClusters) {
            double worst = -1;
            std::size_t chosen = parts.size();
            for (std::size_t i = 0; i < parts.size(); ++i) {
                if (parts[i].size() == 1) continue;
                const double cost = join_all(parts[i]).cost();
                if (cost > worst) {
                    worst = cost;
                    chosen = i;
                }
            }
            if (chosen == parts.size()) break;
            const std::span<Cluster> part = parts[chosen];
            const std::size_t cut = split(part, join_all(part));
            parts[chosen] = part.first(cut);
            parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(chosen) + 1, part.subspan(cut));
        }
        return parts;
    }

    /// Reorders the lights into two parts, neither empty; returns the size of the first.
    static std::size_t split(std::span<Cluster> lights, const Cluster& all) {
        Bounds3 centers;
        for (const Cluster& light : lights) centers.extend(light.bounds.center());
        const Vec3 extent = centers.extent();
        const auto bin_of = [&](const Cluster& light, int axis) {
            const float at = (light.bounds.center()[axis] - centers.lo[axis]) / extent[axis];
            return std::min(static_cast<int>(at * kBins), kBins - 1);
        };
        double best = std::numeric_limits<double>::infinity();
        int best_axis = -1, best_bin = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(extent[axis] > 0)) continue;
            std::array<Cluster, kBins> bins;
            for (const Cluster& light : lights) bins[static_cast<std::size_t>(bin_of(light, axis))].add(light);
            // Long thin boxes are cut across.
            const double thinness = double{max_component(all.bounds.extent())} / double{all.bounds.extent()[axis]};
            std::array<double, kBins> below{};
            Cluster sum;
            for (std::size_t i = 0; i + 1 < kBins; ++i) {
                sum.add(bins[i]);
                below[i] = sum.power > 0 ? sum.cost() : std::numeric_limits<double>::infinity();
            }
            sum = {};
            for (std::size_t i = kBins - 1; i > 0; --i) {
                sum.add(bins[i]);
                const double cost = thinness * (below[i - 1] + sum.cost());
                if (sum.power > 0 && cost < best) {
                    best = cost;
                    best_axis = axis;
                    best_bin = static_cast<int>(i);
                }
            }
        }
        if (best_axis < 0) return lights.size() / 2;
        const auto middle = std::partition(lights.begin(), lights.end(),
                                           [&](const Cluster& c) { return bin_of(c, best_axis) < best_bin; });
        return static_cast<std::size_t>(middle - lights.begin());
    }
};

LightTree::LightTree(std::span<const AreaLight> lights, LightChoice choice) : choice_(choice) {
    std::vector<Cluster> clusters;
    double total = 0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const AreaLight& light = lights[i];
        double power = light.power();
        const Bounds3 bounds = bounds_of(light);
        if (!(power > 0 && std::isfinite(power) && is_finite(bounds.lo) && is_finite(bounds.hi))) continue;
        if (choice == LightChoice::uniform) power = 1;
        const bool sphere = light.kind == AreaLight::Kind::sphere;
        clusters.push_back({.bounds = bounds,
                            .normals = {sphere ? Vec3d(0, 0, 1) : Vec3d(light.normal), sphere ? std::numbers::pi : 0},
                            .power = power,
                            .two_sided = light.two_sided,
                            .light = i});
        total += power;
    }
    light_count_ = static_cast<std::uint32_t>(clusters.size());
    if (clusters.empty()) return;
    only_light_ = clusters[0].light;
    if (clusters.size() == 1) return;
    places_.resize(lights.size());
    nodes_.resize(clusters.size() - 1);
    Builder builder{nodes_, places_, total};
    builder.build(clusters);
    nodes_.resize(builder.node_count);
    nodes_.shrink_to_fit();
}

LightClusters::Lanes<float> LightTree::weights(const LightReceiver& receiver, const LightClusters& clusters) const {
    return choice_ == LightChoice::arriving ? light_importance(receiver, clusters) : clusters.power;
}

std::optional<LightTree::Draw> LightTree::draw(const LightReceiver& receiver, float u) const {
    if (nodes_.empty()) return Draw{only_light_, 1, u};
    float probability = 1;
    for (const Node* node = nodes_.data();;) {
        const LightClusters::Lanes<float> sent = weights(receiver, node->clusters);
        const float total = sum(sent);
        if (!(total > 0 && total < kInfinity)) return std::nullopt;  // none, or beyond the range of float
        float rest = u * total;
        std::size_t lane = kClusters;
        for (std::size_t i = 0; i < kClusters; ++i) {
            if (sent[i] == 0) continue;
            lane = i;
            if (rest < sent[i]) break;
            rest -= sent[i];
        }
        probability *= sent[lane] / total;
        u = std::clamp(rest / sent[lane], 0.0f, 1 - kUnitRoundoff);
        const std::uint32_t child = node->child[lane];
        if (child >= kLeaf) return probability > 0 ? std::optional(Draw{child - kLeaf, probability, u}) : std::nullopt;
        node = &nodes_[child];
    }
}

float LightTree::probability(const LightReceiver& receiver, std::uint32_t light) const {
    if (nodes_.empty()) return light == only_light_ ? 1.0f : 0.0f;
    float probability = 1;
    auto [node, lane] = places_[light];
    if (node == kNone) return 0;
    for (; node != kNone; lane = nodes_[node].lane_of_parent, node = nodes_[node].parent) {
        const LightClusters::Lanes<float> sent = weights(receiver, nodes_[node].clusters);
        const float total = sum(sent);
        if (!(total > 0 && total < kInfinity)) return 0;
        probability *= sent[lane] / total;
    }
    return probability;
}

}  // namespace rayuela
