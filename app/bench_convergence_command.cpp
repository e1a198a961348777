#include "app/bench_command.h"
#include "app/bench_convergence_plot.h"
#include "app/bench_convergence_report.h"
#include "app/progress_bar.h"
#include "app/subcommands.h"
#include "app/write_displayed.h"
#include "app/write_text.h"
#include "ui/assets_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

struct ConvergenceOptions {
    std::vector<std::filesystem::path> scenes;
    std::vector<std::filesystem::path> reference;  ///< Two, or none.
    std::filesystem::path references, json, plot;
    std::vector<int> spp{64};
    std::vector<std::string> set, compare;
    int seeds = 16, threads = 1;
};

/// One number N stands for the powers of two below it and N itself.
std::vector<int> checkpoints(std::vector<int> spp) {
    if (spp.size() == 1) {
        for (int n = 1; n < spp[0]; n *= 2) spp.push_back(n);
    }
    std::ranges::sort(spp);
    spp.erase(std::unique(spp.begin(), spp.end()), spp.end());
    return spp;
}

std::string stem(const std::filesystem::path& scene) {
    return scene.stem().stem().string();
}

Result<void> find_reference(const ConvergenceOptions& options, ConvergencePlan& plan) {
    if (!options.reference.empty()) {
        plan.reference_a = options.reference[0];
        plan.reference_b = options.reference[1];
        return {};
    }
    const std::filesystem::path folder =
        options.references.empty() ? assets_folder() / "references" : options.references;
    for (const char* extension : {".exr", ".pfm"}) {
        const auto half = [&](const char* name) { return folder / (stem(plan.scene) + name + extension); };
        std::error_code error;
        if (!std::filesystem::exists(half("_a"), error)) continue;
        plan.reference_a = half("_a");
        plan.reference_b = half("_b");
        return {};
    }
    return fail(plan.scene.string(), "",
                fmt::format("there is no reference {0}_a.exr or .pfm in {1}; make one with\n"
                            "  rayuela reference {2} -o {1}/{0}_a.exr,{1}/{0}_b.exr",
                            stem(plan.scene), folder.string(), plan.scene.string()));
}

/// Scenes of the assets that have a reference there.
std::vector<std::filesystem::path> scenes_with_references(const ConvergenceOptions& options) {
    std::vector<std::filesystem::path> scenes;
    for (const Example& example : example_scenes()) {
        ConvergencePlan plan{.scene = example.file};
        if (find_reference(options, plan)) scenes.push_back(example.file);
    }
    return scenes;
}

Result<std::vector<ConvergencePlan>> make_plans(const ConvergenceOptions& options) {
    const auto variants = make_variants(options.set, options.compare);
    if (!variants) return tl::unexpected(variants.error());
    const auto scenes = options.scenes.empty() ? scenes_with_references(options) : options.scenes;
    if (scenes.empty()) return fail("", "", "name a scene: none of the examples has a reference");
    if (!options.reference.empty() && scenes.size() != 1) {
        return fail("", "--reference", "belongs to one scene; for several there is --references FOLDER");
    }
    std::vector<ConvergencePlan> plans;
    for (const auto& scene : scenes) {
        ConvergencePlan plan{.scene = scene,
                             .variants = *variants,
                             .spp = checkpoints(options.spp),
                             .seeds = options.seeds,
                             .threads = options.threads};
        if (auto found = find_reference(options, plan); !found) return tl::unexpected(found.error());
        plans.push_back(std::move(plan));
    }
    return plans;
}

bool is_svg(const std::filesystem::path& plot) {
    return plot.extension() == ".svg";
}

/// Before minutes are spent on what could not be written.
Result<void> check_outputs(const ConvergenceOptions& options) {
    const std::filesystem::path& plot = options.plot;
    if (!plot.empty() && !is_svg(plot) && plot.extension() != ".png")
        return fail(plot.string(), "--plot", "must end in .svg or .png");
    return check_folder(plot).and_then([&] { return check_folder(options.json); });
}

Result<void> write_plot(const std::filesystem::path& plot, const std::vector<SceneConvergence>& scenes) {
    if (plot.empty()) return {};
    const PlotSheet sheet = convergence_plot(scenes);
    if (is_svg(plot)) return write_text(plot, plot_svg(sheet));
    return plot_image(sheet).and_then([&](Image image) { return write_displayed(plot, std::move(image)); });
}

Result<void> run_convergence(const ConvergenceOptions& options) {
    if (auto writable = check_outputs(options); !writable) return writable;
    const auto plans = make_plans(options);
    if (!plans) return tl::unexpected(plans.error());
    std::vector<SceneConvergence> scenes;
    for (const ConvergencePlan& plan : *plans) {
        Result<SceneConvergence> measured;
        {
            ProgressBar bar;
            measured =
                measure_convergence(plan, [&](double fraction, const std::string& text) { bar.show(fraction, text); });
        }
        if (!measured) return tl::unexpected(measured.error());
        scenes.push_back(std::move(*measured));
        const SceneConvergence& scene = scenes.back();
        fmt::print("{}: {} x {}, {} seeds, {} threads\n{}\n", scene.name, scene.width, scene.height, plan.seeds,
                   options.threads, checkpoint_table(scene));
        std::fflush(stdout);
    }
    fmt::print("{}\n{}", summary_table(scenes),
               "Seconds are CPU seconds with loading and building; efficiency is 1 / (relMSE s). Intervals are of 95%. "
               "* extrapolated as "
               "1 / samples; < reached by the first image already; ! the interval does not contain 1.\n");
    if (const std::string table = comparison_table(scenes); !table.empty()) fmt::print("\n{}", table);
    return write_text(options.json, convergence_json(scenes).dump(2) + '\n').and_then([&] {
        return write_plot(options.plot, scenes);
    });
}

}  // namespace

BenchKind add_bench_convergence(CLI::App& bench) {
    const auto options = std::make_shared<ConvergenceOptions>();
    CLI::App& command = *bench.add_subcommand("convergence", "Error of the image against run time");
    command.add_option("scenes", options->scenes, "Scenes; without any the examples that have references");
    command.add_option("--reference", options->reference, "Two halves of the reference: A,B")
        ->delimiter(',')
        ->expected(2);
    command.add_option("--references", options->references, "Folder of <scene>_a and <scene>_b, .exr or .pfm");
    command.add_option("--seeds", options->seeds, "Independent renders")->check(CLI::Range(1, 10000));
    command.add_option("--spp", options->spp, "Samples a pixel: N for 1, 2, 4...N, or a list to measure at")
        ->delimiter(',')
        ->check(CLI::Range(1, 1 << 20));
    command.add_option("--threads", options->threads, "Worker threads; 0 is one a hardware thread")
        ->check(CLI::Range(0, 1024));
    const std::string names = fmt::format("{}", fmt::join(setting_names(), ", "));
    command.add_option("--set", options->set, "Change a setting of the scenes, NAME=VALUE: " + names)
        ->allow_extra_args(false);
    command.add_option("--compare", options->compare, "Measure values of a setting side by side, NAME=VALUE,VALUE...")
        ->allow_extra_args(false);
    command.add_option("--json", options->json, "Write all figures to this file");
    command.add_option("--plot", options->plot, "Draw error over time: .svg or .png");
    return {&command, [options] { return run_convergence(*options); }};
}

}  // namespace rayuela
