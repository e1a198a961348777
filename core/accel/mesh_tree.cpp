#include "core/accel/mesh_tree.h"

#include "core/accel/kd_merge.h"
#include "core/accel/parallel.h"
#include "core/accel/triangle_runs.h"

#include <algorithm>

namespace rayuela {
namespace {

UnsetVector<Bounds3> triangle_bounds(const TriangleMesh& mesh, const BuildControl& control) {
    UnsetVector<Bounds3> bounds(mesh.triangles.size());
    parallel_ranges(bounds.size(), 4096, [&](std::size_t begin, std::size_t end) {
        if (control.cancelled) return;
        for (std::size_t i = begin; i < end; ++i) {
            const glm::uvec3& t = mesh.triangles[i];
            const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
            // min and max drop a NaN; the build drops what is not finite.
            const bool usable = is_finite(a) && is_finite(b) && is_finite(c);
            bounds[i] = usable ? Bounds3{min(a, min(b, c)), max(a, max(b, c))} : Bounds3();
        }
    });
    return bounds;
}

void write_leaf(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, float* runs) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[triangles[i]];
        write_triangle({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, i, triangles.size(), runs);
    }
}

UnsetVector<float> make_leaf_data(const TriangleMesh& mesh, const KdTree& tree, const BuildControl& control) {
    const std::size_t size = kTriangleRuns * tree.references.size();
    UnsetVector<float> data(size + kRunPadding);
    std::fill_n(data.end() - kRunPadding, kRunPadding, 0.0f);
    parallel_ranges(tree.nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
        if (control.cancelled) return;
        for (std::size_t i = begin; i < end; ++i) {
            const KdNode& node = tree.nodes[i];
            if (!node.is_leaf() || node.count() == 0) continue;
            write_leaf(mesh, std::span(tree.references).subspan(node.first(), node.count()),
                       data.data() + kTriangleRuns * node.first());
        }
    });
    return data;
}

std::optional<KdTree> build_tree(const TriangleMesh& mesh, const AccelSettings& settings, const MeshTree* known,
                                 BuildControl& control) {
    const auto bounds = triangle_bounds(mesh, control);
    if (control.cancelled) return {};
    return build_kd_tree({.bounds = bounds,
                          .mesh = &mesh,
                          .split = settings.split,
                          .leaf_size = settings.leaf_size,
                          .known = known ? &known->tree : nullptr,
                          .known_leaf_size = known ? known->leaf_size : 0},
                         control);
}

std::optional<KdTree> merged_tree(const TriangleMesh& mesh, const MeshTree& known, int leaf_size,
                                  BuildControl& control) {
    control.done.fetch_add(mesh.triangles.size() - known.tree.primitives, std::memory_order_relaxed);
    return merge_leaves(known.tree, known.split, leaf_size, control);
}

/// Null when cancelled.
std::shared_ptr<const MeshTree> finish(const std::shared_ptr<const TriangleMesh>& mesh, KdTree tree,
                                       const AccelSettings& settings, const BuildControl& control) {
    auto result = std::make_shared<MeshTree>();
    result->tree = std::move(tree);
    fork_join([&] { result->stats = result->tree.stats(); },
              [&] { result->leaf_data = make_leaf_data(*mesh, result->tree, control); });
    if (control.cancelled) return nullptr;
    result->stats.primitives = mesh->triangles.size();
    result->stats.memory_bytes += (kTriangleRuns * result->tree.references.size() + kRunPadding) * sizeof(float);
    result->mesh = mesh;
    result->split = settings.split;
    result->leaf_size = settings.leaf_size;
    return result;
}

}  // namespace

std::shared_ptr<const MeshTree> make_mesh_leaf(const std::shared_ptr<const TriangleMesh>& mesh) {
    const BuildControl control;
    const auto bounds = triangle_bounds(*mesh, control);
    KdTree tree;
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
        if (!fits_a_tree(bounds[i])) continue;
        tree.references.push_back(i);
        tree.bounds.extend(bounds[i]);
    }
    tree.nodes = {KdNode::leaf(0, static_cast<std::uint32_t>(tree.references.size()))};
    tree.primitives = tree.references.size();
    return finish(mesh, std::move(tree), {.leaf_size = kMaxLeafSize}, control);
}

std::shared_ptr<const MeshTree> build_mesh_tree(const std::shared_ptr<const TriangleMesh>& mesh,
                                                const AccelSettings& settings, BuildControl& control,
                                                const MeshTree* known) {
    if (known && known->split != settings.split) known = nullptr;
    auto tree = known && known->leaf_size <= settings.leaf_size
                    ? merged_tree(*mesh, *known, settings.leaf_size, control)
                    : build_tree(*mesh, settings, known, control);
    return tree ? finish(mesh, std::move(*tree), settings, control) : nullptr;
}

}  // namespace rayuela
