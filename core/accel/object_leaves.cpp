#include "core/accel/object_leaves.h"

#include "core/accel/triangle_runs.h"

namespace rayuela {
namespace {

bool is_world_sphere(const TracedObject& object) {
    return object.in_world && std::holds_alternative<SphereD>(object.shape);
}

class LeafWriter {
public:
    LeafWriter(std::span<const TracedObject> objects, std::span<const Bounds3> bounds, ObjectLeaves& out)
        : objects_(objects), bounds_(bounds), out_(out) {}

    ObjectLeaf write(std::span<const std::uint32_t> references) {
        ObjectLeaf leaf;
        leaf.first_triangle = size_of(out_.triangles);
        leaf.first_sphere = size_of(out_.spheres);
        leaf.first_other = size_of(out_.others);
        corners_.clear();
        for (const std::uint32_t index : references) sort_in(index);
        leaf.triangles = size_of(out_.triangles) - leaf.first_triangle;
        leaf.spheres = size_of(out_.spheres) - leaf.first_sphere;
        leaf.others = size_of(out_.others) - leaf.first_other;
        write_triangles(leaf);
        write_spheres(leaf);
        write_others(leaf);
        return leaf;
    }

    /// Of the triangles that were written last.
    std::span<const TriangleCorners> corners() const { return corners_; }
    std::vector<std::array<float, 12>> padded_corners() const {
        std::vector<std::array<float, 12>> result;
        for (const auto& [a, b, c] : corners_) result.push_back({a.x, a.y, a.z, 0, b.x, b.y, b.z, 0, c.x, c.y, c.z, 0});
        return result;
    }

private:
    template <typename T>
    static std::uint32_t size_of(const std::vector<T>& v) {
        return static_cast<std::uint32_t>(v.size());
    }

    void sort_in(std::uint32_t index) {
        const TracedObject& object = objects_[index];
        if (const auto* triangle = std::get_if<TriangleCorners>(&object.shape)) {
            corners_.push_back(*triangle);
            out_.triangles.push_back({index, ObjectTriangle::whole});
        } else if (const auto* quad = std::get_if<QuadCorners>(&object.shape)) {
            for (std::size_t half = 0; half < 2; ++half) {
                const auto& [a, b, c] = kQuadHalves[half];
                corners_.push_back({(*quad)[a], (*quad)[b], (*quad)[c]});
                out_.triangles.push_back({index, half == 0 ? ObjectTriangle::first_half : ObjectTriangle::second_half});
            }
        } else if (is_world_sphere(object)) {
            out_.spheres.push_back(index);
        } else {
            out_.others.push_back(index);
        }
    }

    void write_triangles(const ObjectLeaf& leaf) {
        const std::size_t n = leaf.triangles;
        out_.triangle_runs.resize(kTriangleRuns * (leaf.first_triangle + n));
        float* const runs = out_.triangle_runs.data() + kTriangleRuns * leaf.first_triangle;
        for (std::size_t i = 0; i < n; ++i) write_triangle(corners_[i], i, n, runs);
    }

    void write_spheres(const ObjectLeaf& leaf) {
        const std::size_t n = leaf.spheres;
        out_.sphere_runs.resize(4 * (leaf.first_sphere + n));
        float* const runs = out_.sphere_runs.data() + 4 * leaf.first_sphere;
        for (std::size_t i = 0; i < n; ++i) {
            const SphereD& sphere = std::get<SphereD>(objects_[out_.spheres[leaf.first_sphere + i]].shape);
            for (int axis = 0; axis < 3; ++axis)
                runs[static_cast<std::size_t>(axis) * n + i] = static_cast<float>(sphere.center[axis]);
            runs[3 * n + i] = static_cast<float>(sphere.radius);
        }
    }

    void write_others(const ObjectLeaf& leaf) {
        const std::size_t n = leaf.others;
        out_.other_bounds.resize(6 * (leaf.first_other + n));
        float* const runs = out_.other_bounds.data() + 6 * leaf.first_other;
        for (std::size_t i = 0; i < n; ++i) {
            const Bounds3& bounds = bounds_[out_.others[leaf.first_other + i]];
            for (int axis = 0; axis < 3; ++axis) {
                runs[static_cast<std::size_t>(axis) * n + i] = bounds.lo[axis];
                runs[static_cast<std::size_t>(axis + 3) * n + i] = bounds.hi[axis];
            }
        }
    }

    std::span<const TracedObject> objects_;
    std::span<const Bounds3> bounds_;
    ObjectLeaves& out_;
    std::vector<TriangleCorners> corners_;
};

}  // namespace

std::uint64_t ObjectLeaves::memory_bytes() const {
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    return bytes(leaves) + bytes(triangle_runs) + bytes(triangles) + bytes(apart_corners) + bytes(sphere_runs) +
           bytes(spheres) + bytes(others) + bytes(other_bounds) + bytes(exact_spheres) + apart_pairs.memory_bytes();
}

ObjectLeaves make_object_leaves(std::span<const TracedObject> objects, std::span<const Bounds3> bounds,
                                const KdTree* tree, std::span<const std::uint32_t> apart) {
    ObjectLeaves result;
    LeafWriter writer(objects, bounds, result);
    result.apart = writer.write(apart);
    result.apart_corners = writer.padded_corners();
    result.apart_pairs = pair_triangles(writer.corners());
    result.triangle_runs = {};
    if (tree) result.leaves.resize(tree->references.size());
    for (const KdNode& node : tree ? std::span(tree->nodes) : std::span<const KdNode>()) {
        if (!node.is_leaf() || node.count() == 0) continue;
        result.leaves[node.first()] = writer.write(std::span(tree->references).subspan(node.first(), node.count()));
    }
    result.triangle_runs.resize(result.triangle_runs.size() + kRunPadding);
    result.sphere_runs.resize(result.sphere_runs.size() + kRunPadding);
    result.other_bounds.resize(result.other_bounds.size() + kRunPadding);
    if (result.spheres.empty()) return result;
    result.exact_spheres.resize(objects.size());
    for (const std::uint32_t index : result.spheres)
        result.exact_spheres[index] = std::get<SphereD>(objects[index].shape);
    return result;
}

}  // namespace rayuela
