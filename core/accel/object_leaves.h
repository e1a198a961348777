#pragma once

#include "core/accel/kd_tree.h"
#include "core/accel/traced_object.h"
#include "core/accel/triangle_pairs.h"

#include <array>
#include <span>
#include <vector>

namespace rayuela {

/// The primitives of a leaf over objects, those of a kind side by side as SIMD wants them.
struct ObjectLeaf {
    std::uint32_t first_triangle = 0, triangles = 0;  ///< Quads are two.
    std::uint32_t first_sphere = 0, spheres = 0;
    std::uint32_t first_other = 0, others = 0;

    bool empty() const { return triangles == 0 && spheres == 0 && others == 0; }
};

/// A triangle of a leaf: an object of its own or half of a quad.
struct ObjectTriangle {
    std::uint32_t object;
    enum Kind : std::uint32_t { whole, first_half, second_half } kind;
};

/// What the leaves of the tree over the objects hold, and what stands apart from it, to be tested with every ray.
struct ObjectLeaves {
    ObjectLeaf apart;                  ///< Begins all that follows but `leaves`.
    std::vector<ObjectLeaf> leaves;    ///< One a reference of the tree; that of a leaf stands at its first().
    std::vector<float> triangle_runs;  ///< See triangle_runs.h. Those apart are in pairs instead.
    std::vector<ObjectTriangle> triangles;
    /// Of those apart: three corners, each with a float that says nothing.
    std::vector<std::array<float, 12>> apart_corners;
    TrianglePairs apart_pairs;           ///< Of the same triangles.
    std::vector<float> sphere_runs;      ///< For a leaf of n spheres: n times x, n times y, z and radius.
    std::vector<std::uint32_t> spheres;  ///< Objects.
    std::vector<std::uint32_t> others;   ///< Objects of all other shapes, meshes among them.
    std::vector<float> other_bounds;     ///< For a leaf of n others: n times lo.x, lo.y, lo.z, hi.x, hi.y and hi.z.
    std::vector<SphereD> exact_spheres;  ///< One an object; only those of spheres in the world are used.

    std::uint64_t memory_bytes() const;
};

/// `bounds` are those of the objects; `tree` may be null.
ObjectLeaves make_object_leaves(std::span<const TracedObject> objects, std::span<const Bounds3> bounds,
                                const KdTree* tree, std::span<const std::uint32_t> apart);

}  // namespace rayuela
