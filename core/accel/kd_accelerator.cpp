#include "core/accel/kd_accelerator.h"

#include "core/accel/parallel.h"

#include <algorithm>
#include <chrono>

namespace rayuela {
namespace {

bool same_trees(const AccelSettings& a, const AccelSettings& b) {
    return a.split == b.split && a.leaf_size == b.leaf_size;
}

}  // namespace

std::shared_ptr<const KdAccelerator> KdAccelerator::build(std::vector<GeometryInstance> instances,
                                                          const AccelSettings& settings, const KdAccelerator* previous,
                                                          BuildControl& control) {
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<KdAccelerator> result(new KdAccelerator);
    result->instances_ = std::move(instances);
    result->settings_ = settings;
    result->objects_.reserve(result->instances_.size());
    for (const GeometryInstance& instance : result->instances_) result->objects_.emplace_back(instance);
    if (!result->build_meshes(previous, control) || !result->build_objects(control)) return nullptr;
    result->stats_.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

bool KdAccelerator::build_meshes(const KdAccelerator* previous, BuildControl& control) {
    const bool reusable = previous && same_trees(previous->settings_, settings_);
    const auto tree_of = [](const auto& trees, const TriangleMesh* mesh) {
        const auto found =
            std::find_if(trees.begin(), trees.end(), [&](const auto& t) { return t->mesh.get() == mesh; });
        return found == trees.end() ? nullptr : *found;
    };
    std::vector<std::shared_ptr<const TriangleMesh>> missing;
    for (const TracedObject& object : objects_) {
        const TriangleMesh* mesh = object.mesh();
        if (!mesh || tree_of(mesh_trees_, mesh)) continue;
        if (auto tree = reusable ? tree_of(previous->mesh_trees_, mesh) : nullptr) {
            mesh_trees_.push_back(std::move(tree));
        } else if (std::none_of(missing.begin(), missing.end(), [&](const auto& m) { return m.get() == mesh; })) {
            missing.push_back(std::get<std::shared_ptr<const TriangleMesh>>(object.shape));
        }
    }
    for (const auto& mesh : missing) control.total += mesh->triangles.size();
    control.total += objects_.size();

    std::vector<std::shared_ptr<const MeshTree>> built(missing.size());
    parallel_ranges(missing.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) built[i] = build_mesh_tree(missing[i], settings_, control);
    });
    if (control.cancelled || std::count(built.begin(), built.end(), nullptr) > 0) return false;
    mesh_trees_.insert(mesh_trees_.end(), built.begin(), built.end());

    for (const TracedObject& object : objects_) {
        const auto tree = object.mesh() ? tree_of(mesh_trees_, object.mesh()) : nullptr;
        mesh_of_object_.push_back(tree.get());
    }
    return true;
}

bool KdAccelerator::build_objects(BuildControl& control) {
    std::vector<Bounds3> bounds;
    for (std::uint32_t i = 0; i < objects_.size(); ++i) {
        const MeshTree* mesh = mesh_of_object_[i];
        bounds.push_back(world_bounds(objects_[i], instances_[i], mesh ? mesh->tree.bounds : Bounds3()));
        if (objects_[i].is_plane()) planes_.push_back(i);
        if (!mesh) ++stats_.primitives;
    }
    auto tree = build_kd_tree({.bounds = bounds, .split = settings_.split, .leaf_size = settings_.leaf_size}, control);
    if (!tree) return false;
    tree_ = std::move(*tree);
    leaves_ = make_object_leaves(objects_, tree_);
    for (const auto& mesh_tree : mesh_trees_) stats_ += mesh_tree->stats;
    stats_ += tree_.stats();
    stats_.memory_bytes += objects_.size() * sizeof(TracedObject) + leaves_.memory_bytes();
    return true;
}

}  // namespace rayuela
