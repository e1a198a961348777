#include "app/bench_command.h"
#include "app/skip_gains.h"
#include "app/subcommands.h"
#include "app/text_table.h"
#include "app/write_text.h"
#include "ui/assets_path.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

struct SkipsOptions {
    std::vector<std::filesystem::path> scenes;
    std::filesystem::path json;
    SkipGainOptions gain;
};

nlohmann::ordered_json describe(const std::string& scene, const std::vector<SkipGain>& gains) {
    nlohmann::ordered_json result = {{"scene", scene}, {"gains", nlohmann::json::array()}};
    for (const SkipGain& gain : gains) {
        result["gains"].push_back({{"shortcut", gain.shortcut->key},
                                   {"name", gain.skip},
                                   {"ratio", gain.ratio.value},
                                   {"interval", {gain.ratio.interval.low, gain.ratio.interval.high}}});
    }
    return result;
}

void print(const std::string& scene, const std::vector<SkipGain>& gains) {
    TextTable table(1, {scene, "time with it / without", "95% interval"});
    for (const SkipGain& gain : gains) {
        const auto& [value, interval] = gain.ratio;
        table.add({std::string(gain.skip), fmt::format("{:.3f}", value),
                   fmt::format("{:.3f} - {:.3f}", interval.low, interval.high)});
    }
    fmt::print("{}\n", table.text());
    std::fflush(stdout);
}

Result<void> run_skips(const SkipsOptions& options) {
    std::vector<std::filesystem::path> scenes = options.scenes;
    if (scenes.empty()) {
        for (const Example& example : example_scenes()) scenes.push_back(example.file);
    }
    nlohmann::ordered_json all = nlohmann::json::array();
    for (const auto& file : scenes) {
        const auto scene = load_scene(file);
        if (!scene) return tl::unexpected(scene.error());
        const auto gains = measure_skips(*scene, options.gain);
        if (!gains) return tl::unexpected(gains.error());
        print(file.stem().stem().string(), *gains);
        all.push_back(describe(file.stem().stem().string(), *gains));
    }
    return write_text(options.json, all.dump(2) + '\n');
}

}  // namespace

BenchKind add_bench_skips(CLI::App& bench) {
    CLI::App& command = *bench.add_subcommand("skips", "What each thing left out saves, one thread");
    const auto options = std::make_shared<SkipsOptions>();
    command.add_option("scene", options->scenes, "Scenes to measure (all examples)");
    command.add_option("--side", options->gain.side, "Longest side of the image")->check(CLI::Range(8, 4096));
    command.add_option("--spp", options->gain.samples, "Samples a pixel")->check(CLI::Range(1, 4096));
    command.add_option("--repetitions", options->gain.repetitions, "Rounds, interleaved")->check(CLI::Range(1, 1000));
    command.add_option("--json", options->json, "Write the figures to this file");
    return {&command, [options] { return run_skips(*options); }};
}

}  // namespace rayuela
