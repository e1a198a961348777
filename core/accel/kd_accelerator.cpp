#include "core/accel/kd_accelerator.h"

#include "core/accel/large_objects.h"
#include "core/accel/parallel.h"

#include <algorithm>
#include <chrono>
#include <unordered_set>

namespace rayuela {
namespace {

bool is_for(const MeshTree& tree, const AccelSettings& settings) {
    return tree.split == settings.split && tree.leaf_size == settings.leaf_size;
}

AccelSettings settings_for(const TriangleMesh& mesh, AccelSettings settings) {
    if (deserves_draft(mesh, settings)) settings.leaf_size = kDraftLeafSize;
    return settings;
}

}  // namespace

std::shared_ptr<const KdAccelerator> KdAccelerator::build(std::vector<GeometryInstance> instances,
                                                          const AccelSettings& settings, const KdAccelerator* previous,
                                                          const KdAccelerator* better, BuildControl& control) {
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<KdAccelerator> result(new KdAccelerator);
    result->instances_ = std::move(instances);
    result->settings_ = settings;
    result->objects_.reserve(result->instances_.size());
    for (const GeometryInstance& instance : result->instances_) result->objects_.emplace_back(instance);
    if (previous) result->mesh_trees_ = previous->mesh_trees_;
    if (better) {
        for (const auto& [mesh, tree] : better->mesh_trees_) result->mesh_trees_.insert_or_assign(mesh, tree);
    }
    if (!result->build_meshes(control) || !result->build_objects(control)) return nullptr;
    result->stats_.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

/// Makes the trees that are not among mesh_trees_ yet.
bool KdAccelerator::build_meshes(BuildControl& control) {
    std::erase_if(mesh_trees_, [&](const auto& entry) {
        return entry.second->mesh.expired() || entry.second->split != settings_.split;
    });

    std::vector<std::shared_ptr<const TriangleMesh>> missing;
    std::unordered_set<const TriangleMesh*> seen;
    for (const TracedObject& object : objects_) {
        if (!object.mesh() || !seen.insert(object.mesh()).second) continue;
        const auto tree = mesh_trees_.find(object.mesh());
        const bool there = tree != mesh_trees_.end();
        if (!there || !(is_for(*tree->second, settings_) || deserves_draft(*object.mesh(), settings_)))
            missing.push_back(std::get<std::shared_ptr<const TriangleMesh>>(object.shape));
    }
    for (const auto& mesh : missing) control.total += mesh->triangles.size();
    control.total += objects_.size();

    std::vector<std::shared_ptr<const MeshTree>> built(missing.size());
    parallel_ranges(missing.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto known = mesh_trees_.find(missing[i].get());
            built[i] = build_mesh_tree(missing[i], settings_for(*missing[i], settings_), control,
                                       known != mesh_trees_.end() ? known->second.get() : nullptr);
        }
    });
    if (control.cancelled || std::count(built.begin(), built.end(), nullptr) > 0) return false;
    for (std::size_t i = 0; i < missing.size(); ++i) mesh_trees_[missing[i].get()] = std::move(built[i]);

    for (const TracedObject& object : objects_)
        mesh_of_object_.push_back(object.mesh() ? mesh_trees_.at(object.mesh()).get() : nullptr);
    settings_.draft =
        std::ranges::any_of(mesh_of_object_, [&](const MeshTree* tree) { return tree && !is_for(*tree, settings_); });
    return true;
}

bool KdAccelerator::build_objects(BuildControl& control) {
    std::vector<Bounds3> bounds;
    for (std::uint32_t i = 0; i < objects_.size(); ++i) {
        const MeshTree* mesh = mesh_of_object_[i];
        bounds.push_back(world_bounds(objects_[i], instances_[i], mesh ? mesh->bounds : Bounds3()));
        if (objects_[i].is_plane()) planes_.push_back(i);
        if (!mesh) ++stats_.primitives;
    }
    if (!build_object_tree(bounds, control)) return false;
    if (!leaves_.apart.empty()) bounds_ = std::move(bounds);
    const std::unordered_set<const MeshTree*> in_use(mesh_of_object_.begin(), mesh_of_object_.end());
    for (const auto& [mesh, mesh_tree] : mesh_trees_) {
        if (in_use.contains(mesh_tree.get())) {
            stats_ += mesh_tree->stats;
        } else {
            stats_.kept_bytes += mesh_tree->stats.memory_bytes;
        }
    }
    stats_ += tree_.stats();
    stats_.memory_bytes += objects_.size() * sizeof(TracedObject) + leaves_.memory_bytes();
    return true;
}

/// The tree over the objects with these bounds, and what stands apart from it.
bool KdAccelerator::build_object_tree(std::span<const Bounds3> bounds, BuildControl& control) {
    const bool few = tests_few_objects(settings_, objects_.size());
    std::vector<std::uint32_t> apart;
    if (settings_.split == KdSplit::sah && !few) apart = find_large_objects(objects_, bounds);
    large_objects_ = apart.size();
    if (!settings_.few_objects) apart.clear();

    std::vector<Bounds3> in_tree(bounds.begin(), bounds.end());
    for (const std::uint32_t i : apart) in_tree[i] = {};
    const int leaf_size = few && settings_.few_objects ? std::max(settings_.leaf_size, static_cast<int>(kFewObjects))
                                                       : settings_.leaf_size;
    auto tree = build_kd_tree({.bounds = in_tree, .split = settings_.split, .leaf_size = leaf_size}, control);
    if (!tree) return false;
    tree_ = std::move(*tree);
    all_apart_ = settings_.few_objects && tree_.nodes.size() == 1;
    if (all_apart_) apart.insert(apart.end(), tree_.references.begin(), tree_.references.end());
    leaves_ = make_object_leaves(objects_, bounds, all_apart_ ? nullptr : &tree_, apart);
    all_bounds_ = tree_.bounds;
    for (const std::uint32_t i : apart) all_bounds_.extend(bounds[i]);
    return true;
}

}  // namespace rayuela
