#include "app/bench_convergence.h"

#include "app/clocks.h"
#include "app/subcommands.h"
#include "core/io/image_io.h"
#include "core/render/progressive_renderer.h"
#include "core/scene/scene_edit.h"

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

Result<Reference> read_reference(const ConvergencePlan& plan) {
    Reference reference;
    for (auto [file, image] :
         {std::pair(&plan.reference_a, &reference.a), std::pair(&plan.reference_b, &reference.b)}) {
        auto read = read_image(*file, ColorDecoding::linear);
        if (!read) return tl::unexpected(read.error());
        *image = std::move(*read);
    }
    const auto size = [](const Image& image) { return fmt::format("{} x {}", image.width, image.height); };
    if (size(*reference.a) != size(*reference.b)) {
        return fail(plan.reference_b.string(), "",
                    fmt::format("is {}, the other half {}", size(*reference.b), size(*reference.a)));
    }
    return reference;
}

/// The film becomes as large as the reference, which has to show the same.
Result<Scene> at_size_of(const Image& reference, const Scene& scene) {
    FilmSettings film = scene.film;
    if (std::int64_t{reference.width} * film.height != std::int64_t{reference.height} * film.width) {
        return fail(reference.source, "",
                    fmt::format("is {} x {}, which is not the shape of the scene's film of {} x {}", reference.width,
                                reference.height, film.width, film.height));
    }
    film.width = reference.width;
    film.height = reference.height;
    return apply(scene, SetFilm{film});
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
    const auto loaded = load_scene(plan.scene);
    if (!loaded) return tl::unexpected(loaded.error());
    SceneConvergence result{.name = plan.scene.stem().stem().string(),
                            .load_cpu_seconds = loading.cpu(),
                            .load_wall_seconds = loading.wall()};
    const auto reference = read_reference(plan);
    if (!reference) return tl::unexpected(reference.error());
    const auto scene = at_size_of(*reference->a, *loaded);
    if (!scene) return tl::unexpected(scene.error());
    result.width = scene->film.width;
    result.height = scene->film.height;
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
