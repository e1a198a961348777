#pragma once

#include "app/bench_meshes.h"
#include "core/accel/accel_settings.h"
#include "core/math/result.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace rayuela {

struct RaysOptions {
    std::vector<std::string> meshes;  ///< Names of made ones, or files.
    std::vector<int> leaf_sizes{AccelSettings().leaf_size};
    std::filesystem::path json;
    int side = 512, repetitions = 11, builds = 3;
    bool median_split = false, list = false;
    std::vector<std::string> isas;
    std::vector<int> threads;        ///< Not empty: how rays and builds scale with these.
    std::vector<int> leaf_steps;     ///< Not empty: what changes of the leaf size take, along these and back.
    std::vector<std::string> sizes;  ///< Not empty: the cost of a ray at these counts of triangles (parse_count).
};

// Each prints a table and returns its figures.

/// The contestants on one thread. An error where they disagree.
Result<nlohmann::json> bench_rays(const RaysOptions& options, const BenchMesh& mesh);
/// What several threads do, beside Embree.
nlohmann::json bench_scaling(const RaysOptions& options, const BenchMesh& mesh);
/// What it takes to change the leaf size of a tree that is there, beside building it anew.
nlohmann::json bench_leaf_steps(const RaysOptions& options, const BenchMesh& mesh);
/// What a ray costs in open land of growing detail, beside Embree.
nlohmann::json bench_sizes(const RaysOptions& options);

}  // namespace rayuela
