#pragma once

#include "app/bench_variant.h"
#include "core/math/image.h"
#include "core/render/convergence.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rayuela {

/// What is measured on one scene.
struct ConvergencePlan {
    std::filesystem::path scene, reference_a, reference_b;
    std::vector<BenchVariant> variants;
    std::vector<int> spp;  ///< Ascending.
    int seeds = 16;
    int threads = 1;
};

struct VariantRuns {
    BenchVariant variant;
    std::vector<ConvergenceRun> runs;  ///< One a seed.
    std::uint64_t rejected = 0;        ///< Samples, of all runs.
};

struct SceneConvergence {
    std::string name;
    int width = 0, height = 0;
    double load_cpu_seconds = 0, load_wall_seconds = 0;
    double reference_uncertainty = 0;  ///< Standard error of the mean ratio.
    std::vector<VariantRuns> variants;

    double samples() const { return static_cast<double>(width) * height; }
};

/// Called between checkpoints with the share of work done.
using Progress = std::function<void(double fraction, const std::string& text)>;

/// Renders every seed with every variant in turn, so that what disturbs the machine disturbs all alike. What it takes to
/// measure errors is not counted.
Result<SceneConvergence> measure_convergence(const ConvergencePlan& plan, const Progress& progress);

}  // namespace rayuela
