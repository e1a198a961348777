#include "core/accel/mesh_tree.h"

#include "core/accel/kd_merge.h"
#include "core/accel/large_objects.h"
#include "core/accel/large_pages.h"
#include "core/accel/parallel.h"
#include "core/accel/triangle_runs.h"

#include <algorithm>
#include <utility>

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

/// Writes the blocks of all leaves, which from then on begin where KdNode::first says.
UnsetVector<float> place_leaves(const TriangleMesh& mesh, KdTree& tree, const BuildControl& control) {
    constexpr std::size_t kPart = 4096;
    struct Part {
        UnsetVector<float> data;
        std::size_t begin = 0;
    };
    std::vector<Part> parts((tree.nodes.size() + kPart - 1) / kPart);
    const auto each_leaf = [&](std::size_t part, const auto& visit) {
        for (std::size_t i = part * kPart; i < std::min((part + 1) * kPart, tree.nodes.size()); ++i) {
            if (tree.nodes[i].is_leaf() && tree.nodes[i].count() > 0) visit(tree.nodes[i]);
        }
    };
    parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !control.cancelled; ++i) {
            std::size_t triangles = 0;
            each_leaf(i, [&](const KdNode& leaf) { triangles += leaf.count(); });
            parts[i].data.reserve(6 * triangles);
            // The triangles of each leaf come from memory while the blocks of the one before are written.
            KdNode* leaf_before = nullptr;
            const auto write = [&](KdNode& leaf) {
                const auto names = std::span(tree.references).subspan(leaf.first(), leaf.count());
                leaf = KdNode::leaf(static_cast<std::uint32_t>(parts[i].data.size() / LeafBlock::kUnit), leaf.count());
                append_leaf_blocks(mesh, names, parts[i].data);
            };
            each_leaf(i, [&](KdNode& leaf) {
                const auto names = std::span(tree.references).subspan(leaf.first(), std::min(leaf.count(), 32u));
                for (const std::uint32_t name : names) __builtin_prefetch(&mesh.triangles[name]);
                if (leaf_before) write(*leaf_before);
                leaf_before = &leaf;
            });
            if (leaf_before) write(*leaf_before);
        }
    });
    std::size_t size = 0;
    for (Part& part : parts) {
        part.begin = size;
        size += part.data.size();
    }
    UnsetVector<float> data(size + kRunPadding);
    prefer_large_pages(data.data(), data.size() * sizeof(float));
    std::fill_n(data.end() - kRunPadding, kRunPadding, 0.0f);
    parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::ranges::copy(parts[i].data, data.begin() + static_cast<std::ptrdiff_t>(parts[i].begin));
            const std::size_t first = parts[i].begin / LeafBlock::kUnit;
            each_leaf(i, [&](KdNode& leaf) {
                leaf = KdNode::leaf(static_cast<std::uint32_t>(first + leaf.first()), leaf.count());
            });
        }
    });
    return data;
}

/// The triangles that are better tested with every ray than in the leaves of a tree over all. They no longer have bounds.
std::vector<std::uint32_t> take_apart(std::span<Bounds3> bounds, KdSplit split) {
    if (split != KdSplit::sah || bounds.size() <= kLargePrimitives) return {};
    std::vector<std::uint32_t> apart = find_large(bounds, {});
    for (const std::uint32_t i : apart) bounds[i] = {};
    return apart;
}

void add_apart(KdTree& tree, std::span<const std::uint32_t> apart) {
    if (apart.empty()) return;
    tree.apart = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back(
        KdNode::leaf(static_cast<std::uint32_t>(tree.references.size()), static_cast<std::uint32_t>(apart.size())));
    tree.references.insert(tree.references.end(), apart.begin(), apart.end());
}

std::optional<KdTree> build_tree(const TriangleMesh& mesh, const AccelSettings& settings, const MeshTree* known,
                                 BuildControl& control) {
    auto bounds = triangle_bounds(mesh, control);
    if (control.cancelled) return {};
    const std::vector<std::uint32_t> apart = take_apart(bounds, settings.split);
    auto tree = build_kd_tree({.bounds = bounds,
                               .mesh = &mesh,
                               .split = settings.split,
                               .leaf_size = settings.leaf_size,
                               .known = known ? &known->tree : nullptr,
                               .known_leaf_size = known ? known->leaf_size : 0},
                              control);
    if (tree) add_apart(*tree, apart);
    return tree;
}

std::optional<KdTree> merged_tree(const TriangleMesh& mesh, const MeshTree& known, int leaf_size,
                                  BuildControl& control) {
    control.done.fetch_add(mesh.triangles.size() - known.tree.primitives, std::memory_order_relaxed);
    auto tree = merge_leaves(
        known.tree, [&](const KdNode& leaf, std::vector<std::uint32_t>& to) { known.append_references(leaf, to); },
        known.split, leaf_size, control);
    if (tree && known.tree.apart != 0) add_apart(*tree, known.references(known.tree.nodes[known.tree.apart]));
    return tree;
}

/// Null when cancelled.
std::shared_ptr<const MeshTree> finish(const std::shared_ptr<const TriangleMesh>& mesh, KdTree tree,
                                       const AccelSettings& settings, const BuildControl& control) {
    auto result = std::make_shared<MeshTree>();
    result->tree = std::move(tree);
    result->bounds = result->tree.bounds;
    if (result->tree.apart != 0) {
        const KdNode& apart = result->tree.nodes[result->tree.apart];
        for (const std::uint32_t i : std::span(result->tree.references).subspan(apart.first(), apart.count())) {
            for (int corner = 0; corner < 3; ++corner)
                result->bounds.extend(mesh->positions[mesh->triangles[i][corner]]);
        }
    }
    result->leaf_data = place_leaves(*mesh, result->tree, control);
    if (control.cancelled) return nullptr;
    const std::size_t references = std::exchange(result->tree.references, {}).size();
    result->stats = result->tree.stats();
    result->stats.references = references;
    result->stats.primitives = mesh->triangles.size();
    result->stats.memory_bytes += result->leaf_data.size() * sizeof(float);
    result->mesh = mesh;
    result->split = settings.split;
    result->leaf_size = settings.leaf_size;
    return result;
}

}  // namespace

void MeshTree::append_references(const KdNode& leaf, std::vector<std::uint32_t>& to) const {
    const float* data = blocks(leaf.first());
    for (std::uint32_t left = leaf.count(); left > 0;) {
        const LeafBlock block(data);
        for (std::uint32_t i = 0; i < block.triangles(); ++i) to.push_back(block.name(i));
        data += block.size();
        left -= block.triangles();
    }
}

std::vector<std::uint32_t> MeshTree::references(const KdNode& leaf) const {
    std::vector<std::uint32_t> result;
    append_references(leaf, result);
    return result;
}

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
