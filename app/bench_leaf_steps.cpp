#include "app/bench_rays.h"
#include "app/clocks.h"
#include "app/median_ratio.h"
#include "app/text_table.h"
#include "core/accel/accelerator.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

/// Seconds of each round.
struct Builds {
    std::vector<double> wall, cpu;

    void add(std::span<const GeometryInstance> instances, const AccelSettings& settings, const Accelerator* previous) {
        BuildControl control;
        const double wall_start = wall_seconds(), cpu_start = process_cpu_seconds();
        const auto built = Accelerator::build({instances.begin(), instances.end()}, settings, previous, control);
        wall.push_back(wall_seconds() - wall_start);
        cpu.push_back(process_cpu_seconds() - cpu_start);
    }
};

/// One change of the leaf size, by turns from the tree that is there and anew.
void add_step(TextTable& table, nlohmann::json& figures, std::span<const GeometryInstance> instances,
              const AccelSettings& from, int to, int rounds) {
    BuildControl control;
    const auto previous = Accelerator::build({instances.begin(), instances.end()}, from, nullptr, control);
    AccelSettings settings = from;
    settings.leaf_size = to;
    Builds kept, anew;
    for (int round = 0; round < rounds; ++round) {
        kept.add(instances, settings, previous.get());
        anew.add(instances, settings, nullptr);
    }
    const Measured share = median_ratio(kept.cpu, anew.cpu);
    const auto milliseconds = [](const std::vector<double>& seconds) { return 1e3 * median(seconds); };
    const auto text = [&](const std::vector<double>& seconds) { return fmt::format("{:.0f}", milliseconds(seconds)); };
    const std::string split = from.split == KdSplit::sah ? "sah" : "median";
    table.add({split, fmt::format("{} to {}", from.leaf_size, to), text(kept.wall), text(kept.cpu), text(anew.wall),
               text(anew.cpu), short_number(share.value), interval_text(share.interval)});
    figures.push_back({{"split", split},
                       {"from", from.leaf_size},
                       {"to", to},
                       {"milliseconds", milliseconds(kept.wall)},
                       {"cpu_milliseconds", milliseconds(kept.cpu)},
                       {"anew_milliseconds", milliseconds(anew.wall)},
                       {"anew_cpu_milliseconds", milliseconds(anew.cpu)},
                       {"cpu_share", share.value},
                       {"share_interval", {share.interval.low, share.interval.high}}});
}

}  // namespace

nlohmann::json bench_leaf_steps(const RaysOptions& options, const BenchMesh& mesh) {
    const std::vector<GeometryInstance> instances{{mesh.make(), {}}};
    TextTable table(2, {"split", "leaf size", "ms", "CPU ms", "anew, ms", "anew, CPU ms", "CPU to anew", "95%"});
    nlohmann::json figures = nlohmann::json::array();
    const std::vector<int>& steps = options.leaf_steps;
    for (const KdSplit split : {KdSplit::sah, KdSplit::median}) {
        if (split == KdSplit::median && !options.median_split) continue;
        const auto step = [&](int from, int to) {
            add_step(table, figures, instances, {.leaf_size = from, .split = split}, to, options.builds);
        };
        for (std::size_t i = 1; i < steps.size(); ++i) step(steps[i - 1], steps[i]);
        for (std::size_t i = steps.size(); i-- > 1;) step(steps[i], steps[i - 1]);
    }
    fmt::print("\n{}: {}\n{}", mesh.name, mesh.description, table.text());
    return {{"mesh", mesh.name}, {"leaf_steps", std::move(figures)}};
}

}  // namespace rayuela
