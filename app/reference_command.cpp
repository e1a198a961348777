#include "app/reference_command.h"

#include "app/bench_variant.h"
#include "app/progress_bar.h"
#include "app/subcommands.h"
#include "core/io/image_io.h"
#include "core/render/progressive_renderer.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

/// Far from the small seeds that people and benchmarks use.
constexpr std::uint32_t kFirstSeed = 0x5eed0000;

/// Independent samples: what pixels and halves have in common they cannot hide from each other. Roulette adds noise only.
constexpr const char* kSettings[] = {"sampler=independent", "russian_roulette=false", "max_seconds=0"};
/// Least code between the scene and the image: every object is tried, light is found by scattering alone.
constexpr const char* kBruteForce[] = {"accelerator=list", "light_sampling=false"};

std::vector<std::string> settings_of(const ReferenceOptions& options, std::uint32_t half) {
    std::vector<std::string> settings(std::begin(kSettings), std::end(kSettings));
    if (options.brute_force) settings.insert(settings.end(), std::begin(kBruteForce), std::end(kBruteForce));
    settings.insert(settings.end(), options.set.begin(), options.set.end());
    settings.push_back(fmt::format("seed={}", kFirstSeed + half));
    settings.push_back(fmt::format("max_samples={}", options.spp));
    return settings;
}

Image render(const VariantScene& variant, int threads, const std::string& name) {
    ProgressiveRenderer renderer(false, threads, variant.options);
    renderer.set_sampling(variant.sampling);
    BuildControl control;
    renderer.take(std::make_shared<const Scene>(variant.scene), control);
    const std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> paths{0};
    ProgressBar bar;
    for (Pass pass = renderer.next_pass(); pass.kind == Pass::Kind::full; pass = renderer.next_pass()) {
        renderer.render(pass, cancelled, paths);
        bar.show(static_cast<double>(pass.samples) / variant.scene.render.max_samples,
                 fmt::format("{}  {} spp", name, pass.samples));
    }
    return renderer.publish(SessionPhase::finished)->image;
}

}  // namespace

Result<void> run_reference(const ReferenceOptions& options) {
    for (const auto& output : options.outputs) {
        if (auto writable = check_output(output); !writable) return writable;
        if (output.extension() == ".png") return fail(output.string(), "", "a reference is linear: .exr or .pfm");
    }
    const auto scene = load_scene(options.scene, {.size = options.size});
    if (!scene) return tl::unexpected(scene.error());
    for (std::uint32_t half = 0; half < 2; ++half) {
        const auto variant = apply_settings(*scene, settings_of(options, half));
        if (!variant) return tl::unexpected(variant.error());
        const auto& output = options.outputs[half];
        const Image image = render(*variant, options.threads, output.filename().string());
        if (auto written = write_image(output, image); !written) return written;
    }
    return {};
}

}  // namespace rayuela
