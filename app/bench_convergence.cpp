#include "app/bench_convergence.h"

#include "app/clocks.h"
#include "app/subcommands.h"
#include "core/io/image_io.h"
#include "core/render/progressive_renderer.h"

#include <fmt/format.h>

#include <chrono>
#include <numeric>

namespace rayuela {

namespace {

/// CPU and wall seconds since it was made.
class Stopwatch {
public:
    double cpu() const { return process_cpu_seconds() - cpu_; }
    double wall() const { return std::chrono::duration<double>(Clock::now() - wall_).count(); }

private:
    using Clock = std::chrono::steady_clock;
    double cpu_ = process_cpu_seconds();
    Clock::time_point wall_ = Clock::now();
};

struct Reference {
    std::shared_ptr<const Image> a, b;

    ReferencePair pair() const { return {a->pixels, b->pixels}; }
};

Result<Reference> read_reference(const ConvergencePlan& plan, const FilmSettings& film) {
    Reference reference;
    for (auto [file, image] :
         {std::pair(&plan.reference_a, &reference.a), std::pair(&plan.reference_b, &reference.b)}) {
        auto read = read_image(*file, ColorDecoding::linear);
        if (!read) return tl::unexpected(read.error());
        *image = std::move(*read);
        const int width = (*image)->width, height = (*image)->height;
        if (width != film.width || height != film.height) {
            return fail(file->string(), "",
                        fmt::format("is {} x {}, the scene's film is {} x {}", width, height, film.width, film.height));
        }
    }
    return reference;
}

/// Renders until every pixel has `spp` samples and adds what that took to `checkpoint`.
void render_to(ProgressiveRenderer& renderer, int spp, Checkpoint& checkpoint) {
    auto scene = std::make_shared<Scene>(renderer.scene());
    scene->render.max_samples = spp;
    BuildControl control;
    renderer.take(std::move(scene), control);
    const std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> paths{0};
    const Stopwatch watch;
    for (Pass pass = renderer.next_pass(); pass.kind == Pass::Kind::full; pass = renderer.next_pass()) {
        renderer.render(pass, cancelled, paths);
    }
    checkpoint.spp = spp;
    checkpoint.cpu_seconds += watch.cpu();
    checkpoint.wall_seconds += watch.wall();
}

ConvergenceRun run_seed(const VariantScene& variant, std::uint32_t seed, const ConvergencePlan& plan,
                        const ReferencePair& reference, std::uint64_t& rejected) {
    auto scene = std::make_shared<Scene>(variant.scene);
    scene->render.seed = seed;
    scene->render.max_seconds = 0;
    ProgressiveRenderer renderer(false, plan.threads, variant.options);
    renderer.set_sampling(variant.sampling);
    ConvergenceRun run;
    BuildControl control;
    const Stopwatch building;
    renderer.take(std::move(scene), control);
    run.build_cpu_seconds = building.cpu();
    run.build_wall_seconds = building.wall();
    Checkpoint checkpoint;
    for (const int spp : plan.spp) {
        render_to(renderer, spp, checkpoint);
        const auto frame = renderer.publish(SessionPhase::finished);
        checkpoint.error = image_error(frame->image.pixels, reference);
        run.checkpoints.push_back(checkpoint);
        if (spp == plan.spp.back()) {
            const auto& counts = frame->statistics.rejected;
            rejected += std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
        }
    }
    return run;
}

}  // namespace

Result<SceneConvergence> measure_convergence(const ConvergencePlan& plan, const Progress& progress) {
    const Stopwatch loading;
    const auto scene = load_scene(plan.scene);
    if (!scene) return tl::unexpected(scene.error());
    SceneConvergence result{.name = plan.scene.stem().stem().string(),
                            .width = scene->film.width,
                            .height = scene->film.height,
                            .load_cpu_seconds = loading.cpu(),
                            .load_wall_seconds = loading.wall()};
    const auto reference = read_reference(plan, scene->film);
    if (!reference) return tl::unexpected(reference.error());
    result.reference_uncertainty = mean_ratio_uncertainty(reference->pair());

    std::vector<VariantScene> scenes;
    for (const BenchVariant& variant : plan.variants) {
        auto applied = apply_settings(*scene, variant.settings);
        if (!applied) return tl::unexpected(applied.error());
        scenes.push_back(std::move(*applied));
        result.variants.push_back({.variant = variant});
    }
    const double runs = plan.seeds * static_cast<double>(scenes.size());
    double done = 0;
    for (int seed = 0; seed < plan.seeds; ++seed) {
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            progress(done++ / runs, fmt::format("{} {} seed {}", result.name, plan.variants[i].name, seed));
            VariantRuns& variant = result.variants[i];
            variant.runs.push_back(
                run_seed(scenes[i], static_cast<std::uint32_t>(seed), plan, reference->pair(), variant.rejected));
        }
    }
    return result;
}

}  // namespace rayuela
