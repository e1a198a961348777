#include "app/bench_ray_sets.h"
#include "app/bench_rays.h"
#include "app/clocks.h"
#include "app/contestant.h"
#include "app/count_text.h"
#include "app/ray_answers.h"
#include "app/text_table.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

/// A row of the table: what the kd-tree and, where it is there, Embree take.
void add_row(TextTable& table, nlohmann::json& figures, const RaySet& set, std::size_t triangles,
             std::span<const Contestant> contestants) {
    std::vector<std::string> row{std::string(set.name), fmt::format("{}", triangles)};
    nlohmann::json entry{{"rays", set.name}, {"triangles", triangles}};
    for (const Contestant& contestant : contestants) {
        const Measured cost = nanoseconds_a_ray(contestant);
        row.push_back(fmt::format("{:.0f}", cost.value));
        entry["nanoseconds"][contestant.name] = cost.value;
    }
    if (contestants.size() > 1) {
        const Measured ratio = speed_ratio(contestants[0], contestants[1]);
        row.push_back(short_number(ratio.value));
        row.push_back(interval_text(ratio.interval));
        entry["to_embree_single_robust"] = ratio.value;
        entry["ratio_interval"] = {ratio.interval.low, ratio.interval.high};
    }
    table.add(std::move(row));
    figures.push_back(std::move(entry));
}

/// The kd-tree, then Embree.
std::vector<Contestant> measure(const RaysOptions& options, const RaySet& set, const Accelerator& kd,
                                const EmbreeRival* embree) {
    const std::size_t n = set.rays.size();
    RayAnswers answers(n);
    std::vector<EmbreeQuery> queries;
    queries.reserve(2);
    std::vector<Contestant> contestants{{"kd", [] {}, [&] { answers.trace(kd, set.rays, set.any_hit(), 0, n); }, n}};
    for (const EmbreeMode mode : {EmbreeMode::single, EmbreeMode::packet16}) {
        if (!embree) break;
        EmbreeQuery& query = queries.emplace_back(set.rays, set.any_hit(), mode, set.coherent());
        contestants.push_back({fmt::format("Embree {} robust", name_of(mode)), [&query] { query.reset(); },
                               [&query, embree, n] { embree->trace(query, 0, n); }, n});
    }
    compete(contestants, options.repetitions, thread_cpu_seconds);
    return contestants;
}

}  // namespace

nlohmann::json bench_sizes(const RaysOptions& options) {
    struct Row {
        RaySet set;
        std::size_t triangles;
        std::vector<Contestant> contestants;
    };
    std::vector<std::vector<Row>> rows_of_kind;
    for (const std::string& text : options.sizes) {
        const BenchMesh land = bench_land(text, *parse_count(text));
        const auto mesh = land.make();
        BuildControl control;
        const auto kd = Accelerator::build({{mesh, {}}}, {}, nullptr, control);
        const auto embree = EmbreeRival::build(*mesh, true);
        std::vector<RaySet> sets = make_ray_sets(*kd, land, options.side);
        rows_of_kind.resize(sets.size());
        for (std::size_t i = 0; i < sets.size(); ++i) {
            if (sets[i].rays.empty()) continue;
            auto contestants = measure(options, sets[i], *kd, embree.get());
            sets[i].rays.clear();
            rows_of_kind[i].push_back({std::move(sets[i]), mesh->triangles.size(), std::move(contestants)});
        }
    }
    TextTable table(1, {"rays", "triangles", "kd, ns", "Embree single robust, ns", "Embree packet 16 robust, ns",
                        "kd to single", "95%"});
    nlohmann::json figures = nlohmann::json::array();
    for (const auto& rows : rows_of_kind) {
        for (const Row& row : rows) add_row(table, figures, row.set, row.triangles, row.contestants);
    }
    fmt::print("{}", table.text());
    return figures;
}

}  // namespace rayuela
