#pragma once

#include "core/accel/traced_object.h"

namespace rayuela {

/// Tests every object in turn, and of a mesh every triangle in turn. Slow and plain: the oracle for all other structures.
class ListAccelerator final : public Accelerator {
public:
    ListAccelerator(std::vector<GeometryInstance> instances, const AccelSettings& settings);

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override;
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override;
    AccelStats stats() const override { return stats_; }
    const AccelSettings& settings() const override { return settings_; }
    std::span<const GeometryInstance> instances() const override { return instances_; }
    Bounds3 bounds() const override { return bounds_; }

private:
    std::vector<GeometryInstance> instances_;
    std::vector<TracedObject> objects_;
    AccelSettings settings_;
    AccelStats stats_;
    Bounds3 bounds_;
};

}  // namespace rayuela
