#include "app/bench_command.h"
#include "app/bench_file_mesh.h"
#include "app/bench_rays.h"
#include "app/count_text.h"
#include "app/isa_option.h"
#include "app/write_text.h"

#include <algorithm>

namespace rayuela {

namespace {

/// A made mesh by its name, or one from a file.
Result<BenchMesh> find_mesh(const std::string& name) {
    const std::vector<BenchMesh> made = bench_meshes();
    const auto found = std::ranges::find(made, name, &BenchMesh::name);
    return found != made.end() ? Result<BenchMesh>(*found) : read_bench_mesh(name);
}

Result<nlohmann::json> run_mesh(const RaysOptions& options, const BenchMesh& mesh) {
    if (!options.leaf_steps.empty()) return bench_leaf_steps(options, mesh);
    return options.threads.empty() ? bench_rays(options, mesh) : bench_scaling(options, mesh);
}

Result<nlohmann::json> run_meshes(const RaysOptions& options) {
    std::vector<std::string> names = options.meshes;
    if (names.empty()) {
        for (const BenchMesh& mesh : bench_meshes()) names.push_back(mesh.name);
    }
    nlohmann::json all = nlohmann::json::array();
    for (const std::string& name : names) {
        const auto mesh = find_mesh(name);
        if (!mesh) return tl::unexpected(mesh.error());
        auto result = run_mesh(options, *mesh);
        if (!result) return tl::unexpected(result.error());
        all.push_back(std::move(*result));
    }
    return all;
}

Result<void> run_rays(const RaysOptions& options) {
    const auto all = options.sizes.empty() ? run_meshes(options) : bench_sizes(options);
    if (!all) return tl::unexpected(all.error());
    return write_text(options.json, all->dump(2) + '\n');
}

/// The name of a made mesh or an existing file.
std::string check_mesh(const std::string& name) {
    if (std::filesystem::exists(name)) return "";
    std::string message = name + " is neither a file nor one of";
    for (const BenchMesh& mesh : bench_meshes()) {
        if (mesh.name == name) return "";
        message += " " + mesh.name;
    }
    return message;
}

std::string check_count(const std::string& text) {
    return parse_count(text) ? "" : text + " is no count like 700, 10k or 1M";
}

}  // namespace

BenchKind add_bench_rays(CLI::App& bench) {
    CLI::App& command = *bench.add_subcommand("rays", "Rays a second of the kd-tree, the list and Embree, one thread");
    const auto options = std::make_shared<RaysOptions>();
    options->isas = {std::string(instruction_sets().front())};
    command
        .add_option("mesh", options->meshes, "Meshes to measure: made ones by name, scene and mesh files (all made)")
        ->check(check_mesh);
    command.add_option("--leaf-size", options->leaf_sizes, "Leaf sizes of the kd-tree, side by side")
        ->delimiter(',')
        ->check(CLI::Range(kMinLeafSize, kMaxLeafSize));
    command.add_flag("--median", options->median_split, "The median split beside the surface area heuristic");
    add_isa(command, options->isas)->delimiter(',');
    command.add_flag("--list", options->list, "The list too (a few rays)");
    command.add_option("--side", options->side, "Primary rays a side of the image")->check(CLI::Range(16, 4096));
    command.add_option("--repetitions", options->repetitions, "Rounds, interleaved")->check(CLI::Range(1, 1000));
    auto* threads = command.add_option("--threads", options->threads, "Instead: rays and builds with so many threads");
    threads->delimiter(',')->check(CLI::Range(1, 1024));
    auto* leaf_steps = command.add_option("--leaf-steps", options->leaf_steps,
                                          "Instead: changes of the leaf size, along these and back, beside builds");
    leaf_steps->delimiter(',')->check(CLI::Range(kMinLeafSize, kMaxLeafSize))->excludes(threads);
    command.add_option("--builds", options->builds, "Rounds of builds, with --threads or --leaf-steps")
        ->check(CLI::Range(1, 1000));
    command.add_option("--sizes", options->sizes, "Instead: the cost of a ray in so many triangles, like 1k,10k,1M")
        ->delimiter(',')
        ->check(check_count)
        ->excludes(threads)
        ->excludes(leaf_steps);
    command.add_option("--json", options->json, "Write the figures to this file");
    return {&command, [options] { return run_rays(*options); }};
}

}  // namespace rayuela
