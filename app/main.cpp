#include "app/bench_command.h"
#include "app/isa_option.h"
#include "app/reference_command.h"
#include "app/subcommands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>

namespace rayuela {

namespace {

constexpr int kFailed = 1, kUsage = 2;

/// "640x480" to its two numbers.
void add_size(CLI::App& command, const std::string& help, auto&& store) {
    command
        .add_option_function<std::string>(
            "--size",
            [store](const std::string& text) {
                int width = 0, height = 0, end = 0;
                const int read = std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &end);
                const bool whole = read == 2 && static_cast<std::size_t>(end) == text.size();
                if (!whole || width < 1 || height < 1 || width > kMaxFilmSide || height > kMaxFilmSide) {
                    throw CLI::ValidationError(
                        "--size", fmt::format("\"{}\" is not WIDTHxHEIGHT, each 1 to {}", text, kMaxFilmSide));
                }
                store(glm::ivec2(width, height));
            },
            help)
        ->type_name("WxH");
}

void add_threads(CLI::App& command, int& threads) {
    command.add_option("--threads", threads, "Worker threads; 0 is one a hardware thread")->check(CLI::Range(0, 1024));
}

template <typename T>
void add_choice(CLI::App& command, const std::string& flag, std::optional<T>& value,
                const std::map<std::string, T>& names, const std::string& help) {
    const auto store = [&value, names](const std::string& name) { value = names.at(name); };
    command.add_option_function<std::string>(flag, store, help)->check(CLI::IsMember(names));
}

/// Above 0; unlike CLI::PositiveNumber it refuses what is not a number.
CLI::Validator positive(const std::string& what, const std::string& type = "FLOAT") {
    const auto check = [what](const std::string& text) -> std::string {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value);
        return good ? "" : fmt::format("\"{}\" is not a {} above 0", text, what);
    };
    return CLI::Validator(check, type);
}

void add_render(CLI::App& app, RenderOptions& options) {
    CLI::App& command = *app.add_subcommand("render", "Render a scene to an image file");
    SceneOverrides& overrides = options.overrides;
    command.add_option("scene", options.scene, "Scene: .scene.json, .gltf, .glb, .obj or .ply")->required();
    command.add_option("-o,--output", options.output, "Image: .png, .exr, .pfm or .hdr");
    command.add_option("--spp", overrides.spp, "Stop at so many samples a pixel")->check(CLI::Range(1, 1 << 30));
    command.add_option("--time", overrides.seconds, "Stop after so many seconds")->check(positive("time", "SECONDS"));
    add_size(command, "Size of the image", [&overrides](glm::ivec2 size) { overrides.size = size; });
    command.add_option("--seed", overrides.seed, "Seed of the sampler");
    add_threads(command, options.threads);
    add_isa(command, options.isa)->expected(1);
    add_choice<AcceleratorKind>(command, "--accelerator", overrides.accelerator,
                                {{"list", AcceleratorKind::list}, {"kd", AcceleratorKind::kd}},
                                "Structure that finds hits");
    command.add_option("--kd-leaf-size", overrides.kd_leaf_size, "Primitives a leaf should hold")
        ->check(CLI::Range(kMinLeafSize, kMaxLeafSize));
    add_choice<KdSplit>(command, "--kd-split", overrides.kd_split, {{"median", KdSplit::median}, {"sah", KdSplit::sah}},
                        "How the kd-tree chooses its cuts");
    command.add_option("--max-bounces", overrides.max_bounces, "Scattering events; 0 shows emitters only")
        ->check(CLI::Range(0, 1 << 20));
    command
        .add_option("--adaptive", options.sampling.target_error,
                    "Sample where the noise is, until the relative error is about this (0.02 is 2 %)")
        ->check(CLI::Range(kMinTargetError, kMaxTargetError));
    command
        .add_option("--clamp", options.sampling.clamp,
                    "Darken samples brighter than this; what the image loses by it is reported")
        ->check(positive("value"));
    command.add_option("--stats", options.stats, "Write figures of the render to this JSON file");
    command
        .add_option_function<std::array<int, 3>>(
            "--replay",
            [&options](const std::array<int, 3>& of) {
                options.replay = {of[0], of[1], of[2]};
            },
            "Instead of rendering, print the path of one sample: pixel (from the upper left) and its number")
        ->delimiter(',')
        ->type_name("X,Y,SAMPLE");
}

void add_screenshot(CLI::App& app, ScreenshotOptions& options) {
    CLI::App& command = *app.add_subcommand("screenshot", "Draw the whole window off-screen to an image file");
    command.add_option("scene", options.scene, "Scene to open")->required();
    command.add_option("-o,--output", options.output, "Image: .png, .exr, .pfm or .hdr")->required();
    command.add_option("--spp", options.spp, "Samples a pixel to wait for")->check(CLI::Range(1, 1 << 30));
    add_size(command, "Size of the window", [&options](glm::ivec2 size) { options.size = size; });
    command.add_option("--scale", options.scale, "Scale of the user interface")->check(CLI::Range(0.5, 4.0));
    add_threads(command, options.threads);
}

void add_info(CLI::App& app, InfoOptions& options) {
    CLI::App& command = *app.add_subcommand("info", "Print what a scene holds and how its tree came out");
    command.add_option("scene", options.scene, "Scene to read")->required();
    command.add_flag("--skips", options.skips, "Instead: what the renderer leaves out for this scene, and why");
    command.add_flag("--measure", options.measure, "The same, and how much longer a render takes with each put back");
    command.add_flag("--json", options.json, "As JSON");
}

void add_reference(CLI::App& app, ReferenceOptions& options) {
    CLI::App& command =
        *app.add_subcommand("reference", "Render the two halves that `bench convergence` compares with");
    command.add_option("scene", options.scene, "Scene to render")->required();
    command.add_option("-o,--output", options.outputs, "Two images, A,B: .exr or .pfm")
        ->delimiter(',')
        ->expected(2)
        ->required();
    add_size(command, "Size of the images, which `bench convergence` will render at",
             [&options](glm::ivec2 size) { options.size = size; });
    command.add_option("--spp", options.spp, "Samples a pixel of each half")->check(CLI::Range(1, 1 << 30));
    command.add_option("--set", options.set, "Change a setting, NAME=VALUE")->allow_extra_args(false);
    command.add_flag("--brute-force", options.brute_force, "Without acceleration structure and light sampling");
    add_threads(command, options.threads);
}

Result<void> run(int argc, char** argv, int& usage_status) {
    CLI::App app("Rayuela: an interactive progressive path tracer. Without a command it opens the window.");
    app.set_version_flag("--version", RAYUELA_VERSION);
    app.require_subcommand(0, 1);
    RenderOptions render;
    ScreenshotOptions screenshot;
    InfoOptions info;
    ReferenceOptions reference;
    WindowOptions window;
    app.add_option("scene", window.scene, "Scene to open in the window");
    add_threads(app, window.threads);
    add_render(app, render);
    add_screenshot(app, screenshot);
    add_info(app, info);
    add_reference(app, reference);
    const auto bench_kinds = add_bench(app);
    try {
        app.parse(argc, argv);
        if (app.got_subcommand("render") && render.output.empty() && !render.replay)
            throw CLI::RequiredError("--output");
    } catch (const CLI::ParseError& error) {
        usage_status = app.exit(error) == 0 ? 0 : kUsage;
        return {};
    }
    for (const std::string& isa : render.isa) use_instruction_set(isa);
    if (app.got_subcommand("render")) return render.replay ? run_replay(render) : run_render(render);
    if (app.got_subcommand("screenshot")) return run_screenshot(screenshot);
    if (app.got_subcommand("info")) return run_info(info);
    if (app.got_subcommand("reference")) return run_reference(reference);
    if (app.got_subcommand("bench")) return run_bench(bench_kinds);
    return run_window(window);
}

}  // namespace

}  // namespace rayuela

int main(int argc, char** argv) {
    int usage_status = 0;
    const auto done = rayuela::run(argc, argv, usage_status);
    if (done) return usage_status;
    fmt::print(stderr, "{}\n", rayuela::to_string(done.error()));
    return rayuela::kFailed;
}
