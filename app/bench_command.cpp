#include "app/bench_command.h"

#include <algorithm>

namespace rayuela {

std::vector<BenchKind> add_bench(CLI::App& app) {
    CLI::App& bench = *app.add_subcommand("bench", "Measure speed and convergence");
    bench.require_subcommand(1);
    return {add_bench_convergence(bench), add_bench_first_image(bench), add_bench_rays(bench), add_bench_skips(bench)};
}

Result<void> run_bench(const std::vector<BenchKind>& kinds) {
    const auto asked = std::ranges::find_if(kinds, [](const BenchKind& kind) { return kind.command->parsed(); });
    return asked->run();
}

}  // namespace rayuela
