#pragma once

#include "core/lights/area_light.h"
#include "core/lights/light_importance.h"
#include "core/scene/light_choice.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rayuela {

/// A tree over lights with kClusters children a node, descended at random: at each node towards a child in proportion to the
/// light it is estimated to send to the receiver, by power, distance and the angles on either side, or as LightChoice says. Conty Estevez & Kulla,
/// "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, in the conservative form of PBRT 4th ed.,
/// 12.6.3: only what cannot light the receiver is never drawn. Scaling a scene by a power of two changes nothing.
class LightTree {
public:
    struct Draw {
        std::uint32_t light;
        float probability;
        float remainder;  ///< What the choice leaves of u, in [0, 1): uniform, and stratified where u was.
    };

    LightTree() = default;
    /// Lights without power are left out. Builds in parallel on the calling thread's task arena.
    explicit LightTree(std::span<const AreaLight> lights, LightChoice choice = LightChoice::arriving);

    /// Whether there is nothing to draw: then `draw` and `probability` must not be called.
    bool empty() const { return light_count_ == 0; }
    /// The one light with power, where there is only one.
    std::optional<std::uint32_t> only_light() const {
        return light_count_ == 1 ? std::optional(only_light_) : std::nullopt;
    }
    std::size_t size() const { return light_count_; }
    /// What is known of each light, and which lane is which light, where one node holds them all; else null.
    const LightClusters* only_clusters() const { return nodes_.size() == 1 ? &nodes_[0].clusters : nullptr; }
    std::uint32_t light_in_lane(std::size_t lane) const { return nodes_[0].child[lane] - kLeaf; }

    /// `u` in [0, 1). Nothing where no light can reach the receiver.
    std::optional<Draw> draw(const LightReceiver& receiver, float u) const;
    /// The probability with which `draw` draws the light.
    float probability(const LightReceiver& receiver, std::uint32_t light) const;
    std::uint64_t memory_bytes() const { return nodes_.capacity() * sizeof(Node) + places_.capacity() * sizeof(Place); }

private:
    struct Node {
        LightClusters clusters;
        std::array<std::uint32_t, kClusters> child{};  ///< A node, or a light with kLeaf added.
        std::uint32_t parent = kNone, lane_of_parent = 0;
    };
    /// The lane of a light.
    struct Place {
        std::uint32_t node = kNone, lane = 0;
    };
    struct Cluster;
    struct Builder;

    LightClusters::Lanes<float> weights(const LightReceiver& receiver, const LightClusters& clusters) const;

    static constexpr std::uint32_t kLeaf = 0x80000000u;

    std::vector<Node> nodes_;    ///< The root first. None where there is but one light.
    std::vector<Place> places_;  ///< Of each light.
    std::uint32_t light_count_ = 0, only_light_ = 0;
    LightChoice choice_ = LightChoice::arriving;
};

}  // namespace rayuela
