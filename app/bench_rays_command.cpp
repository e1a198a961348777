#include "app/bench_command.h"
#include "app/bench_ray_sets.h"
#include "app/cpu_clock.h"
#include "app/embree_rival.h"
#include "app/isa_option.h"
#include "app/text_table.h"
#include "core/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

/// More than this many rays in a million that disagree with Embree's robust mode fail the benchmark, if there are too many
/// to be chance: three standard deviations and one ray above.
constexpr double kToleratedPpm = 30;

bool too_many(double ppm, std::size_t rays) {
    const double expected = kToleratedPpm * 1e-6 * static_cast<double>(rays);
    return ppm * 1e-6 * static_cast<double>(rays) > expected + 3 * std::sqrt(expected) + 1;
}

struct RaysOptions {
    std::vector<std::string> meshes;
    std::vector<int> leaf_sizes{AccelSettings().leaf_size};
    std::filesystem::path json;
    int side = 512, repetitions = 11;
    bool median_split = false, list = false;
    std::vector<std::string> isas{std::string(instruction_sets().front())};
};

/// Somebody who answers all rays of a set on one thread.
struct Contestant {
    std::string name;
    std::function<void()> reset, trace;
    std::size_t rays;  ///< That `trace` answers.
    std::vector<double> seconds{};
};

Measured mrays(const Contestant& one) {
    return bootstrap(one.seconds.size(), [&](std::span<const std::size_t> taken) {
        std::vector<double> seconds;
        for (const std::size_t i : taken) seconds.push_back(one.seconds[i]);
        return static_cast<double>(one.rays) / median(std::move(seconds)) * 1e-6;
    });
}

/// Of the speeds in the same rounds.
Measured ratio(const Contestant& ours, const Contestant& theirs) {
    return bootstrap(ours.seconds.size(), [&](std::span<const std::size_t> taken) {
        std::vector<double> ratios;
        for (const std::size_t i : taken) {
            ratios.push_back(theirs.seconds[i] / ours.seconds[i] * static_cast<double>(ours.rays) /
                             static_cast<double>(theirs.rays));
        }
        return median(std::move(ratios));
    });
}

/// Answers of one structure to one set.
struct Answers {
    std::vector<Hit> hits;
    std::vector<std::uint8_t> blocked;

    void trace(const Accelerator& structure, std::span<const Ray> rays, bool any_hit) {
        hits.resize(rays.size());
        blocked.resize(rays.size());
        constexpr std::size_t kBatch = 4096;  // As many as a tile of the renderer carries.
        for (std::size_t i = 0; i < rays.size(); i += kBatch) {
            const std::size_t n = std::min(kBatch, rays.size() - i);
            if (any_hit) {
                structure.occluded(rays.subspan(i, n), std::span(blocked).subspan(i, n));
            } else {
                structure.intersect(rays.subspan(i, n), std::span(hits).subspan(i, n));
            }
        }
    }
    std::uint32_t primitive(std::size_t i, bool any_hit) const {
        return any_hit ? (blocked[i] ? 0 : kNone) : hits[i].primitive;
    }
};

/// Rays in a million on which they name different triangles. At a shared edge both are right: there t decides.
double disagreement(const Answers& ours, const EmbreeQuery& theirs, bool any_hit, std::size_t rays) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        if (ours.primitive(i, any_hit) == theirs.primitive(i)) continue;
        const bool same_place = !any_hit && ours.hits[i].valid() && theirs.primitive(i) != kNone &&
                                std::fabs(ours.hits[i].t - theirs.t(i)) <= 1e-5f * theirs.t(i);
        different += same_place ? 0 : 1;
    }
    return 1e6 * static_cast<double>(different) / static_cast<double>(rays);
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
        TextTable table(1, {"structure", "build CPU s", "MB", "nodes", "references a triangle"});
        for (const Structure& structure : structures_) {
            const AccelStats stats = structure.accelerator->stats();
            const double references = static_cast<double>(stats.references) / static_cast<double>(stats.primitives);
            table.add({structure.name, fmt::format("{:.3f}", structure.cpu_seconds),
                       fmt::format("{:.1f}", static_cast<double>(stats.memory_bytes) * 1e-6),
                       fmt::format("{}", stats.nodes), fmt::format("{:.2f}", references)});
            result_["builds"].push_back({{"structure", structure.name},
                                         {"cpu_seconds", structure.cpu_seconds},
                                         {"memory_bytes", stats.memory_bytes},
                                         {"nodes", stats.nodes},
                                         {"references_per_triangle", references}});
        }
        if (embree_) {
            table.add({"Embree robust", fmt::format("{:.3f}", embree_->build_cpu_seconds()),
                       fmt::format("{:.1f}", static_cast<double>(embree_->memory_bytes()) * 1e-6), "", ""});
        }
        fmt::print("{}", table.text());
        result_["mesh"] = view_.name;
        result_["triangles"] = mesh_->triangles.size();
    }

    Result<void> measure(const RaySet& set, TextTable& table) {
        const std::size_t n = set.rays.size();
        std::vector<Answers> answers(tracers_.size());
        std::vector<Contestant> contestants;
        for (std::size_t k = 0; k < tracers_.size(); ++k) {
            contestants.push_back({tracers_[k].name, [this, k] { use_instruction_set(tracers_[k].isa); },
                                   [&, k] { answers[k].trace(*tracers_[k].accelerator, set.rays, set.any_hit()); }, n});
        }
        const std::size_t few =
            std::min<std::size_t>(n, std::max<std::size_t>(16, 20'000'000 / mesh_->triangles.size()));
        const std::span<const Ray> some(set.rays.data(), few);
        Answers listed;
        listed.trace(*list_.accelerator, some, set.any_hit());
        if (options_.list)
            contestants.push_back({"list", [] {}, [&] { listed.trace(*list_.accelerator, some, set.any_hit()); }, few});
        std::vector<EmbreeQuery> queries;
        if (embree_) {
            const bool coherent = set.kind == RayKind::primary || set.kind == RayKind::shadow;
            for (const EmbreeMode mode : {EmbreeMode::single, EmbreeMode::packet16, EmbreeMode::stream})
                queries.emplace_back(set.rays, set.any_hit(), mode, coherent);
            for (const bool robust : {true, false}) {
                const EmbreeRival& rival = robust ? *embree_ : *embree_fast_;
                for (EmbreeQuery& query : queries) {
                    contestants.push_back({fmt::format("Embree {}{}", name_of(query.mode()), robust ? " robust" : ""),
                                           [&query] { query.reset(); },
                                           [&rival, &query, n] { rival.trace(query, 0, n); }, n});
                }
            }
        }
        for (int round = 0; round <= options_.repetitions; ++round) {  // The first warms up.
            for (Contestant& contestant : contestants) {
                contestant.reset();
                const double start = thread_cpu_seconds();
                contestant.trace();
                if (round > 0) contestant.seconds.push_back(thread_cpu_seconds() - start);
            }
        }
        if (embree_) {
            queries[0].reset();
            embree_->trace(queries[0], 0, n);
        }
        return report(set, contestants, answers, listed, few, queries, table);
    }

    Result<void> report(const RaySet& set, const std::vector<Contestant>& contestants,
                        const std::vector<Answers>& answers, const Answers& listed, std::size_t few,
                        const std::vector<EmbreeQuery>& queries, TextTable& table) {
        const auto single = std::ranges::find(contestants, "Embree single robust", &Contestant::name);
        std::vector<std::string> wrong;
        for (std::size_t k = 0; k < contestants.size(); ++k) {
            const Measured speed = mrays(contestants[k]);
            nlohmann::json entry{{"rays", set.name},
                                 {"who", contestants[k].name},
                                 {"mrays_per_second", speed.value},
                                 {"interval", {speed.interval.low, speed.interval.high}}};
            std::vector<std::string> row{std::string(set.name),
                                         contestants[k].name,
                                         fmt::format("{:.2f}", speed.value),
                                         fmt::format("{:.2f} - {:.2f}", speed.interval.low, speed.interval.high),
                                         "",
                                         "",
                                         ""};
            if (single != contestants.end()) {
                const Measured times = ratio(contestants[k], *single);
                row[4] = fmt::format("{:.2f}", times.value);
                row[5] = fmt::format("{:.2f} - {:.2f}", times.interval.low, times.interval.high);
                entry["to_embree_single_robust"] = times.value;
                entry["ratio_interval"] = {times.interval.low, times.interval.high};
            }
            if (k < answers.size()) {
                if (!queries.empty()) {
                    const double ppm = disagreement(answers[k], queries[0], set.any_hit(), set.rays.size());
                    row[6] = fmt::format("{:.0f}", ppm);
                    entry["differs_ppm"] = ppm;
                    if (too_many(ppm, set.rays.size()))
                        wrong.push_back(
                            fmt::format("{} and Embree on {:.0f} rays in a million", contestants[k].name, ppm));
                }
                for (std::size_t i = 0; i < few; ++i) {
                    const bool same = set.any_hit() ? listed.blocked[i] == answers[k].blocked[i]
                                                    : listed.hits[i].t == answers[k].hits[i].t &&
                                                          listed.hits[i].primitive == answers[k].hits[i].primitive;
                    if (!same) wrong.push_back(fmt::format("{} and the list on ray {}", contestants[k].name, i));
                }
            }
            table.add(std::move(row));
            result_["speeds"].push_back(std::move(entry));
        }
        if (wrong.empty()) return {};
        return fail(std::string(view_.name), std::string(set.name), "these disagree: " + wrong.front());
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

Result<void> run_rays(const RaysOptions& options) {
    nlohmann::json all = nlohmann::json::array();
    for (const BenchMesh& mesh : bench_meshes()) {
        const bool asked =
            options.meshes.empty() || std::ranges::find(options.meshes, mesh.name) != options.meshes.end();
        if (!asked) continue;
        auto result = RaysBench(options, mesh).run();
        if (!result) return tl::unexpected(result.error());
        all.push_back(std::move(*result));
    }
    if (options.json.empty()) return {};
    std::ofstream file(options.json);
    file << all.dump(2) << '\n';
    if (!file) return fail(options.json.string(), "", "the file could not be written");
    return {};
}

}  // namespace

BenchKind add_bench_rays(CLI::App& bench) {
    CLI::App& command = *bench.add_subcommand("rays", "Rays a second of the kd-tree, the list and Embree, one thread");
    const auto options = std::make_shared<RaysOptions>();
    std::vector<std::string> names;
    for (const BenchMesh& mesh : bench_meshes()) names.emplace_back(mesh.name);
    command.add_option("mesh", options->meshes, "Meshes to measure (all)")->check(CLI::IsMember(names));
    command.add_option("--leaf-size", options->leaf_sizes, "Leaf sizes of the kd-tree, side by side")
        ->delimiter(',')
        ->check(CLI::Range(kMinLeafSize, kMaxLeafSize));
    command.add_flag("--median", options->median_split, "The median split beside the surface area heuristic");
    add_isa(command, options->isas)->delimiter(',');
    command.add_flag("--list", options->list, "The list too (a few rays)");
    command.add_option("--side", options->side, "Primary rays a side of the image")->check(CLI::Range(16, 4096));
    command.add_option("--repetitions", options->repetitions, "Rounds, interleaved")->check(CLI::Range(1, 1000));
    command.add_option("--json", options->json, "Write the figures to this file");
    return {&command, [options] { return run_rays(*options); }};
}

}  // namespace rayuela
