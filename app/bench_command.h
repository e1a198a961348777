#pragma once

#include "core/math/result.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <vector>

namespace rayuela {

/// A kind of `rayuela bench`: its subcommand, and what does it with the options parsed.
struct BenchKind {
    CLI::App* command;
    std::function<Result<void>()> run;
};

/// Adds `bench` and its kinds to the commands of `app`.
std::vector<BenchKind> add_bench(CLI::App& app);
/// Runs the kind that was asked for.
Result<void> run_bench(const std::vector<BenchKind>& kinds);

// Each adds one kind to `bench`.
BenchKind add_bench_convergence(CLI::App& bench);
BenchKind add_bench_first_image(CLI::App& bench);
BenchKind add_bench_rays(CLI::App& bench);
BenchKind add_bench_skips(CLI::App& bench);

}  // namespace rayuela
