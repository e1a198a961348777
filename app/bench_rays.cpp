#include "app/bench_rays.h"

#include "app/bench_ray_sets.h"
#include "app/clocks.h"
#include "app/contestant.h"
#include "app/ray_answers.h"
#include "app/text_table.h"
#include "core/math/isa.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

namespace {

/// More than this many rays in a million that disagree with Embree's robust mode fail the benchmark, if there are too many
/// to be chance: three standard deviations and one ray above.
constexpr double kToleratedPpm = 30;

bool too_many(double ppm, std::size_t rays) {
    const double expected = kToleratedPpm * 1e-6 * static_cast<double>(rays);
    return ppm * 1e-6 * static_cast<double>(rays) > expected + 3 * std::sqrt(expected) + 1;
}

struct Structure {
    std::string name;
    std::shared_ptr<const Accelerator> accelerator;
    double cpu_seconds = 0;
};

/// A structure traced with one set of instructions.
struct Tracer {
    std::string name;
    std::string_view isa;
    const Accelerator* accelerator;
};

class RaysBench {
public:
    RaysBench(const RaysOptions& options, const BenchMesh& mesh) : options_(options), view_(mesh), mesh_(mesh.make()) {}

    Result<nlohmann::json> run() {
        fmt::print("\n{}: {} ({} triangles)\n", view_.name, view_.description, mesh_->triangles.size());
        for (const int leaf_size : options_.leaf_sizes) {
            add(fmt::format("kd sah {}", leaf_size), {.leaf_size = leaf_size});
            if (options_.median_split)
                add(fmt::format("kd median {}", leaf_size), {.leaf_size = leaf_size, .split = KdSplit::median});
        }
        list_ = build("list", {.kind = AcceleratorKind::list});
        embree_ = EmbreeRival::build(*mesh_, true);
        embree_fast_ = EmbreeRival::build(*mesh_, false);
        print_builds();
        for (const Structure& structure : structures_) {
            for (const std::string& isa : options_.isas) {
                const std::string suffix = options_.isas.size() > 1 ? " " + isa : "";
                tracers_.push_back({structure.name + suffix, isa, structure.accelerator.get()});
            }
        }
        TextTable table(2, {"rays", "who", "Mrays/s", "95%", "to Embree single robust", "95%", "differ, ppm"});
        for (const RaySet& set : make_ray_sets(*structures_.front().accelerator, view_, options_.side)) {
            if (set.rays.empty()) continue;
            const Result<void> measured = measure(set, table);
            if (!measured) return tl::unexpected(measured.error());
        }
        fmt::print("{}", table.text());
        return result_;
    }

private:
    Structure build(std::string name, const AccelSettings& settings) const {
        BuildControl control;
        const double start = process_cpu_seconds();
        auto accelerator = Accelerator::build({{mesh_, {}}}, settings, nullptr, control);
        return {std::move(name), std::move(accelerator), process_cpu_seconds() - start};
    }
    void add(std::string name, const AccelSettings& settings) {
        structures_.push_back(build(std::move(name), settings));
    }

    void print_builds() {
        TextTable table(1, {"structure", "build CPU s", "MB", "bytes a triangle", "nodes", "references a triangle"});
        for (const Structure& structure : structures_) {
            const AccelStats stats = structure.accelerator->stats();
            const double references = static_cast<double>(stats.references) / static_cast<double>(stats.primitives);
            add_build(table, structure.name, structure.cpu_seconds, stats.memory_bytes,
                      {fmt::format("{}", stats.nodes), fmt::format("{:.2f}", references)});
            result_["builds"].back()["nodes"] = stats.nodes;
            result_["builds"].back()["references_per_triangle"] = references;
        }
        if (embree_) add_build(table, "Embree robust", embree_->build_cpu_seconds(), embree_->memory_bytes(), {"", ""});
        fmt::print("{}", table.text());
        result_["mesh"] = view_.name;
        result_["triangles"] = mesh_->triangles.size();
    }
    /// Memory is that of the structure, without the mesh itself.
    void add_build(TextTable& table, const std::string& name, double cpu_seconds, std::uint64_t bytes,
                   const std::array<std::string, 2>& more) {
        const double a_triangle = static_cast<double>(bytes) / static_cast<double>(mesh_->triangles.size());
        table.add({name, fmt::format("{:.3f}", cpu_seconds), fmt::format("{:.1f}", static_cast<double>(bytes) * 1e-6),
                   fmt::format("{:.1f}", a_triangle), more[0], more[1]});
        result_["builds"].push_back({{"structure", name},
                                     {"cpu_seconds", cpu_seconds},
                                     {"memory_bytes", bytes},
                                     {"bytes_per_triangle", a_triangle}});
    }

    /// The list answers every so many rays alone.
    std::size_t stride(std::size_t rays) const {
        constexpr std::size_t kTests = 1'000'000'000, kLeast = 256;
        return std::max<std::size_t>(1, rays / std::max(kLeast, kTests / mesh_->triangles.size()));
    }
    static std::vector<Ray> every_nth(std::span<const Ray> rays, std::size_t n) {
        std::vector<Ray> some;
        for (std::size_t i = 0; i < rays.size(); i += n) some.push_back(rays[i]);
        return some;
    }

    Result<void> measure(const RaySet& set, TextTable& table) {
        const std::size_t n = set.rays.size();
        std::vector<RayAnswers> answers(tracers_.size(), RayAnswers(n));
        std::vector<Contestant> contestants;
        for (std::size_t k = 0; k < tracers_.size(); ++k) {
            contestants.push_back(
                {tracers_[k].name, [this, k] { use_instruction_set(tracers_[k].isa); },
                 [&, k] { answers[k].trace(*tracers_[k].accelerator, set.rays, set.any_hit(), 0, n); }, n});
        }
        const std::vector<Ray> some = every_nth(set.rays, stride(n));
        RayAnswers listed(some.size());
        const auto trace_list = [&] { listed.trace(*list_.accelerator, some, set.any_hit(), 0, some.size()); };
        trace_list();
        if (options_.list) contestants.push_back({"list", [] {}, trace_list, some.size()});
        std::vector<EmbreeQuery> queries;
        if (embree_) {
            for (const EmbreeMode mode : {EmbreeMode::single, EmbreeMode::packet16, EmbreeMode::stream})
                queries.emplace_back(set.rays, set.any_hit(), mode, set.coherent());
            for (const bool robust : {true, false}) {
                const EmbreeRival& rival = robust ? *embree_ : *embree_fast_;
                for (EmbreeQuery& query : queries) {
                    contestants.push_back({fmt::format("Embree {}{}", name_of(query.mode()), robust ? " robust" : ""),
                                           [&query] { query.reset(); },
                                           [&rival, &query, n] { rival.trace(query, 0, n); }, n});
                }
            }
        }
        compete(contestants, options_.repetitions, thread_cpu_seconds);
        if (embree_) {
            queries[0].reset();
            embree_->trace(queries[0], 0, n);
        }
        return report(set, contestants, answers, listed, queries, table);
    }

    Result<void> report(const RaySet& set, const std::vector<Contestant>& contestants,
                        const std::vector<RayAnswers>& answers, const RayAnswers& listed,
                        const std::vector<EmbreeQuery>& queries, TextTable& table) {
        const auto single = std::ranges::find(contestants, "Embree single robust", &Contestant::name);
        std::vector<std::string> wrong;
        for (std::size_t k = 0; k < contestants.size(); ++k) {
            const Measured speed = mrays_per_second(contestants[k]);
            nlohmann::json entry{{"rays", set.name},
                                 {"who", contestants[k].name},
                                 {"mrays_per_second", speed.value},
                                 {"interval", {speed.interval.low, speed.interval.high}}};
            std::vector<std::string> row{std::string(set.name),
                                         contestants[k].name,
                                         short_number(speed.value),
                                         interval_text(speed.interval),
                                         "",
                                         "",
                                         ""};
            if (single != contestants.end()) {
                const Measured times = speed_ratio(contestants[k], *single);
                row[4] = short_number(times.value);
                row[5] = interval_text(times.interval);
                entry["to_embree_single_robust"] = times.value;
                entry["ratio_interval"] = {times.interval.low, times.interval.high};
            }
            if (k < answers.size()) {
                if (!queries.empty()) {
                    const double ppm = disagreement(answers[k], queries[0], set.any_hit());
                    row[6] = fmt::format("{:.0f}", ppm);
                    entry["differs_ppm"] = ppm;
                    if (too_many(ppm, set.rays.size()))
                        wrong.push_back(
                            fmt::format("{} and Embree on {:.0f} rays in a million", contestants[k].name, ppm));
                }
                const std::size_t every = stride(set.rays.size());
                for (std::size_t i = 0; i < listed.hits.size(); ++i) {
                    if (!listed.same(i, answers[k], i * every, set.any_hit()))
                        wrong.push_back(fmt::format("{} and the list on ray {}", contestants[k].name, i * every));
                }
            }
            table.add(std::move(row));
            result_["speeds"].push_back(std::move(entry));
        }
        if (wrong.empty()) return {};
        return fail(view_.name, std::string(set.name), "these disagree: " + wrong.front());
    }

    const RaysOptions& options_;
    BenchMesh view_;
    std::shared_ptr<const TriangleMesh> mesh_;
    std::vector<Structure> structures_;
    std::vector<Tracer> tracers_;
    Structure list_;
    std::unique_ptr<const EmbreeRival> embree_, embree_fast_;
    nlohmann::json result_;
};

}  // namespace

Result<nlohmann::json> bench_rays(const RaysOptions& options, const BenchMesh& mesh) {
    return RaysBench(options, mesh).run();
}

}  // namespace rayuela
