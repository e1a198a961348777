#pragma once

#include "core/accel/accel_settings.h"
#include "core/math/ray.h"
#include "core/math/transform.h"
#include "core/shapes/box.h"
#include "core/shapes/mesh.h"
#include "core/shapes/plane.h"
#include "core/shapes/quad.h"
#include "core/shapes/sphere.h"
#include "core/shapes/triangle.h"

#include <atomic>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace rayuela {

/// What a ray can meet: the shapes without the groups, which the render scene has flattened.
using TracedShape = std::variant<Sphere, Plane, Box, Triangle, Quad, std::shared_ptr<const TriangleMesh>>;

/// One shape placed in the world. Its index in the list given to `build` is Hit::object.
struct GeometryInstance {
    TracedShape shape;
    Affine to_world;  ///< Invertible.

    bool operator==(const GeometryInstance&) const = default;
};

struct AccelStats {
    double build_seconds = 0;
    std::uint64_t primitives = 0;  ///< Triangles and shapes; an instanced mesh counts once.
    std::uint64_t references = 0;  ///< Primitives over all leaves; a primitive cut by a plane counts once a side.
    std::uint64_t nodes = 0;       ///< Inner nodes and leaves.
    std::uint64_t leaves = 0;
    std::uint64_t memory_bytes = 0;
    std::uint64_t kept_bytes = 0;  ///< Beyond these, trees of meshes that are hidden or deleted and may come back.
    int depth = 0;                 ///< Of the deepest leaf; a root that is a leaf has depth 0.

    AccelStats& operator+=(const AccelStats& other);
};

/// Shared between a build and whoever watches it. All members may be used from any thread.
struct BuildControl {
    std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> done{0};   ///< Primitives that have reached a leaf.
    std::atomic<std::uint64_t> total{0};  ///< Primitives to be built; progress = done / total.
};

/// Finds the intersections of rays with a scene's shapes. Immutable; list and kd-tree give bit-identical hits.
/// A ray with a NaN or infinite origin or direction, a zero direction or t_min > t_max misses.
class Accelerator {
public:
    virtual ~Accelerator() = default;

    /// Builds in parallel on the calling thread's task arena. Trees of meshes that `previous` has or keeps with the same
    /// settings are shared; those for another leaf size are made from them. Of a mesh that `better` (may be null) has a tree
    /// of, that one is taken. Null when cancelled.
    static std::shared_ptr<const Accelerator> build(std::vector<GeometryInstance> instances,
                                                    const AccelSettings& settings, const Accelerator* previous,
                                                    BuildControl& control, const Accelerator* better = nullptr);

    /// hits[i] becomes the closest hit of rays[i] with t_min <= t <= t_max, ties by is_closer, or an invalid Hit.
    /// rays.size() == hits.size(). One call for a whole batch: the dispatch is a batch's, not a ray's.
    virtual void intersect(std::span<const Ray> rays, std::span<Hit> hits) const = 0;

    /// blocked[i] becomes 1 where `intersect` would find a hit, else 0.
    virtual void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const = 0;

    virtual AccelStats stats() const = 0;
    virtual const AccelSettings& settings() const = 0;
    virtual std::span<const GeometryInstance> instances() const = 0;
    /// Of everything but the planes; empty where there is nothing else.
    virtual Bounds3 bounds() const = 0;
};

}  // namespace rayuela
