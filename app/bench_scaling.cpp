#include "app/bench_ray_sets.h"
#include "app/bench_rays.h"
#include "app/clocks.h"
#include "app/contestant.h"
#include "app/ray_answers.h"
#include "app/scaling.h"
#include "app/text_table.h"
#include "core/accel/parallel.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace rayuela {

namespace {

using Built = std::shared_ptr<const Accelerator>;

/// Calls body(begin, end) for batches of the rays on all threads of the arena.
template <typename Body>
void in_batches(tbb::task_arena& arena, std::size_t rays, const Body& body) {
    constexpr std::size_t kBatch = RayAnswers::kBatch;
    arena.execute([&] {
        parallel_ranges((rays + kBatch - 1) / kBatch, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) body(i * kBatch, std::min(rays, (i + 1) * kBatch));
        });
    });
}

class ScalingBench {
public:
    ScalingBench(const RaysOptions& options, const BenchMesh& mesh)
        : options_(options),
          view_(mesh),
          mesh_(mesh.make()),
          allowed_(tbb::global_control::max_allowed_parallelism,
                   static_cast<std::size_t>(std::ranges::max(options.threads))) {}

    nlohmann::json run() {
        fmt::print("\n{}: {} ({} triangles)\n", view_.name, view_.description, mesh_->triangles.size());
        const Built built = measure_builds();
        embree_ = EmbreeRival::build(*mesh_, true);
        for (const RaySet& set : make_ray_sets(*built, view_, options_.side)) {
            if (!set.rays.empty()) measure_rays(*built, set);
        }
        return report();
    }

private:
    /// Builds in turns; returns the last.
    Built measure_builds() {
        const std::size_t first = runs_.size();
        const auto triangles = static_cast<double>(mesh_->triangles.size());
        for (const int threads : options_.threads) {
            runs_.push_back({"build", "kd", threads, triangles, {}});
            runs_.push_back({"build", "Embree robust", threads, triangles, {}});
        }
        Built built;
        for (int round = 0; round < options_.builds; ++round) {
            for (std::size_t i = first; i < runs_.size(); i += 2) {
                BuildControl control;
                built.reset();
                tbb::task_arena arena(runs_[i].threads);
                const double start = wall_seconds();
                arena.execute([&] { built = Accelerator::build({{mesh_, {}}}, {}, nullptr, control); });
                runs_[i].seconds.push_back(wall_seconds() - start);
                if (const auto rival = EmbreeRival::build(*mesh_, true, runs_[i].threads))
                    runs_[i + 1].seconds.push_back(rival->build_wall_seconds());
            }
        }
        std::erase_if(runs_, [](const ScalingRun& run) { return run.seconds.empty(); });
        return built;
    }

    void measure_rays(const Accelerator& built, const RaySet& set) {
        const std::size_t n = set.rays.size();
        RayAnswers answers(n);
        std::vector<EmbreeQuery> queries;
        queries.reserve(2);
        std::vector<Contestant> contestants;
        std::vector<int> threads_of;
        const auto enter = [&](std::string name, std::function<void()> reset, const auto& body) {
            for (const int threads : options_.threads) {
                const auto arena = std::make_shared<tbb::task_arena>(threads);
                contestants.push_back({name, reset, [arena, n, body] { in_batches(*arena, n, body); }, n});
                threads_of.push_back(threads);
            }
        };
        enter(
            "kd", [] {},
            [&](std::size_t begin, std::size_t end) { answers.trace(built, set.rays, set.any_hit(), begin, end); });
        for (const EmbreeMode mode : {EmbreeMode::single, EmbreeMode::packet16}) {
            if (!embree_) break;
            EmbreeQuery& query = queries.emplace_back(set.rays, set.any_hit(), mode, set.coherent());
            enter(
                fmt::format("Embree {} robust", name_of(mode)), [&query] { query.reset(); },
                [&](std::size_t begin, std::size_t end) { embree_->trace(query, begin, end); });
        }
        compete(contestants, options_.repetitions, wall_seconds);
        for (std::size_t i = 0; i < contestants.size(); ++i) {
            runs_.push_back({std::string(set.name), contestants[i].name, threads_of[i], static_cast<double>(n),
                             std::move(contestants[i].seconds)});
        }
    }

    nlohmann::json report() const {
        TextTable table(2, {"what", "who", "threads", "s", "M a s", "speed-up", "95%"});
        nlohmann::json figures = nlohmann::json::array();
        for (const ScalingFigure& figure : scaling_figures(runs_)) {
            const auto& [value, interval] = figure.speed_up;
            table.add({figure.what, figure.who, fmt::format("{}", figure.threads), short_number(figure.seconds),
                       fmt::format("{:.2f}", figure.speed * 1e-6), fmt::format("{:.2f}", value),
                       interval_text(interval)});
            figures.push_back({{"what", figure.what},
                               {"who", figure.who},
                               {"threads", figure.threads},
                               {"seconds", figure.seconds},
                               {"per_second", figure.speed},
                               {"speed_up", value},
                               {"interval", {interval.low, interval.high}}});
        }
        fmt::print("{}", table.text());
        std::fflush(stdout);
        return {{"mesh", view_.name}, {"triangles", mesh_->triangles.size()}, {"scaling", std::move(figures)}};
    }

    const RaysOptions& options_;
    BenchMesh view_;
    std::shared_ptr<const TriangleMesh> mesh_;
    tbb::global_control allowed_;
    std::unique_ptr<const EmbreeRival> embree_;
    std::vector<ScalingRun> runs_;
};

}  // namespace

nlohmann::json bench_scaling(const RaysOptions& options, const BenchMesh& mesh) {
    return ScalingBench(options, mesh).run();
}

}  // namespace rayuela
