#include "app/bench_convergence_report.h"

#include "app/text_table.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

constexpr double kTargets[] = {1e-2, 1e-3};
constexpr double kTimes[] = {1, 10, 60};

using Values = std::span<const std::size_t>;

double efficiency(const Curve& curve) {
    return 1 / (curve.back().error * curve.back().seconds);
}

/// Of one member of the error at checkpoint `i`, over the seeds.
Measured mean_error(const VariantRuns& variant, std::size_t i, double ImageError::*member) {
    return bootstrap(variant.runs.size(), [&](Values chosen) {
        double sum = 0;
        for (const std::size_t run : chosen) sum += variant.runs[run].checkpoints[i].error.*member;
        return sum / static_cast<double>(chosen.size());
    });
}

double mean_cost(const VariantRuns& variant, std::size_t i, double Checkpoint::*member) {
    double sum = 0;
    for (const ConvergenceRun& run : variant.runs) sum += run.checkpoints[i].*member;
    return sum / static_cast<double>(variant.runs.size());
}

double mean_build(const VariantRuns& variant, double ConvergenceRun::*member) {
    double sum = 0;
    for (const ConvergenceRun& run : variant.runs) sum += run.*member;
    return sum / static_cast<double>(variant.runs.size());
}

/// What all figures of a scene and a variant are derived from.
struct Summary {
    const SceneConvergence& scene;
    const VariantRuns& variant;
    Curve curve;

    Summary(const SceneConvergence& s, const VariantRuns& v) : scene(s), variant(v) {
        std::vector<std::size_t> all(v.runs.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        curve = mean_curve(v.runs, all, s.load_cpu_seconds);
    }

    std::size_t last() const { return variant.runs[0].checkpoints.size() - 1; }
    Measured of(double (*statistic)(const Curve&)) const {
        return measure(variant.runs, scene.load_cpu_seconds, statistic);
    }
    double samples_per_second() const {
        return scene.samples() * variant.runs[0].checkpoints.back().spp /
               mean_cost(variant, last(), &Checkpoint::cpu_seconds);
    }
    /// The noise of the reference widens what the seeds say.
    Measured mean_ratio() const {
        Measured ratio = mean_error(variant, last(), &ImageError::mean_ratio);
        const double reference = 1.96 * scene.reference_uncertainty;
        ratio.interval.low = ratio.value - std::hypot(ratio.value - ratio.interval.low, reference);
        ratio.interval.high = ratio.value + std::hypot(ratio.interval.high - ratio.value, reference);
        return ratio;
    }
};

std::string number(double value) {
    return fmt::format("{:.3g}", value);
}

std::string text(const Measured& measured) {
    return fmt::format("{:.3g} [{:.3g}, {:.3g}]", measured.value, measured.interval.low, measured.interval.high);
}

std::string text(const Reading& reading) {
    const char* mark = reading.kind == Reading::Kind::beyond ? "*" : reading.kind == Reading::Kind::before ? "<" : " ";
    return number(reading.value) + mark;
}

std::string ratio_text(const Measured& ratio) {
    const bool contains_one = ratio.interval.low <= 1 && ratio.interval.high >= 1;
    return fmt::format("{:.4f} [{:.4f}, {:.4f}]{}", ratio.value, ratio.interval.low, ratio.interval.high,
                       contains_one ? "" : " !");
}

/// Of the seconds of each scene to `target` with variant number `variant`; an extrapolated scene marks the mean.
std::string geometric_mean_seconds(const std::vector<SceneConvergence>& scenes, std::size_t variant, double target) {
    double sum = 0;
    Reading mean;
    for (const SceneConvergence& scene : scenes) {
        const Reading seconds = seconds_to(Summary(scene, scene.variants[variant]).curve, target);
        sum += std::log(seconds.value) / static_cast<double>(scenes.size());
        if (seconds.kind == Reading::Kind::beyond) mean.kind = seconds.kind;
    }
    mean.value = std::exp(sum);
    return text(mean);
}

/// Efficiency of `variant` over that of its base, over seeds in pairs.
Measured gain(const SceneConvergence& scene, const VariantRuns& variant, const VariantRuns& base) {
    return bootstrap(variant.runs.size(), [&](Values chosen) {
        const Curve a = mean_curve(variant.runs, chosen, scene.load_cpu_seconds);
        const Curve b = mean_curve(base.runs, chosen, scene.load_cpu_seconds);
        return a.empty() || b.empty() ? std::nan("") : efficiency(a) / efficiency(b);
    });
}

nlohmann::ordered_json json(const Measured& measured) {
    return {{"value", measured.value}, {"low", measured.interval.low}, {"high", measured.interval.high}};
}

nlohmann::ordered_json json(const Reading& reading) {
    constexpr const char* kKinds[] = {"measured", "extrapolated", "at most"};
    return {{"value", reading.value}, {"kind", kKinds[static_cast<int>(reading.kind)]}};
}

nlohmann::ordered_json checkpoint_json(const VariantRuns& variant, std::size_t i) {
    return {{"spp", variant.runs[0].checkpoints[i].spp},
            {"cpu_seconds", mean_cost(variant, i, &Checkpoint::cpu_seconds)},
            {"wall_seconds", mean_cost(variant, i, &Checkpoint::wall_seconds)},
            {"relmse", json(mean_error(variant, i, &ImageError::rel_mse))},
            {"relmse_trimmed", json(mean_error(variant, i, &ImageError::rel_mse_trimmed))},
            {"rmse", json(mean_error(variant, i, &ImageError::rmse))},
            {"mape", json(mean_error(variant, i, &ImageError::mape))},
            {"percentile_99_9", json(mean_error(variant, i, &ImageError::worst_mille))},
            {"mean_ratio", json(mean_error(variant, i, &ImageError::mean_ratio))}};
}

nlohmann::ordered_json variant_json(const SceneConvergence& scene, const VariantRuns& variant) {
    const Summary summary(scene, variant);
    nlohmann::ordered_json result = {{"settings", variant.variant.settings},
                                     {"seeds", variant.runs.size()},
                                     {"build_cpu_seconds", mean_build(variant, &ConvergenceRun::build_cpu_seconds)},
                                     {"build_wall_seconds", mean_build(variant, &ConvergenceRun::build_wall_seconds)},
                                     {"rejected_samples", variant.rejected},
                                     {"samples_per_cpu_second", summary.samples_per_second()},
                                     {"mean_ratio", json(summary.mean_ratio())}};
    for (std::size_t i = 0; i <= summary.last(); ++i) result["checkpoints"].push_back(checkpoint_json(variant, i));
    if (summary.curve.empty()) return result;
    result["slope"] = json(summary.of(convergence_slope));
    result["efficiency"] = json(summary.of(efficiency));
    for (const double target : kTargets) {
        result["seconds_to"][number(target)] = json(seconds_to(summary.curve, target));
        result["samples_to"][number(target)] = json(samples_to(summary.curve, target));
    }
    for (const double time : kTimes) result["relmse_after"][number(time)] = json(error_at(summary.curve, time));
    const VariantRuns& base = scene.variants[variant.variant.base];
    if (&base != &variant)
        result["gain"] = {{"over", base.variant.name}, {"efficiency", json(gain(scene, variant, base))}};
    return result;
}

}  // namespace

std::string checkpoint_table(const SceneConvergence& scene) {
    TextTable table(1, {"variant", "spp", "CPU s", "wall s", "relMSE [95%]", "trimmed", "RMSE", "MAPE", "99.9%"});
    for (const VariantRuns& variant : scene.variants) {
        for (std::size_t i = 0; i < variant.runs[0].checkpoints.size(); ++i) {
            const auto mean = [&](double ImageError::*member) { return number(mean_error(variant, i, member).value); };
            table.add({variant.variant.name, fmt::to_string(variant.runs[0].checkpoints[i].spp),
                       number(mean_cost(variant, i, &Checkpoint::cpu_seconds)),
                       number(mean_cost(variant, i, &Checkpoint::wall_seconds)),
                       text(mean_error(variant, i, &ImageError::rel_mse)), mean(&ImageError::rel_mse_trimmed),
                       mean(&ImageError::rmse), mean(&ImageError::mape), mean(&ImageError::worst_mille)});
        }
    }
    return table.text();
}

std::string summary_table(const std::vector<SceneConvergence>& scenes) {
    TextTable table(2, {"scene", "variant", "load+build s", "Ms/s", "relMSE", "mean / reference", "slope", "efficiency",
                        "s to 1e-2", "s to 1e-3", "spp to 1e-3", "in 1 s", "in 10 s", "in 60 s"});
    for (const SceneConvergence& scene : scenes) {
        for (const VariantRuns& variant : scene.variants) {
            const Summary summary(scene, variant);
            const double build = mean_build(variant, &ConvergenceRun::build_cpu_seconds);
            std::vector<std::string> row = {scene.name,
                                            variant.variant.name,
                                            number(scene.load_cpu_seconds + build),
                                            number(1e-6 * summary.samples_per_second()),
                                            number(mean_error(variant, summary.last(), &ImageError::rel_mse).value),
                                            ratio_text(summary.mean_ratio())};
            if (!summary.curve.empty()) {
                row.push_back(text(summary.of(convergence_slope)));
                row.push_back(text(summary.of(efficiency)));
                for (const double target : kTargets) row.push_back(text(seconds_to(summary.curve, target)));
                row.push_back(text(samples_to(summary.curve, kTargets[1])));
                for (const double time : kTimes) row.push_back(text(error_at(summary.curve, time)));
            }
            table.add(std::move(row));
        }
    }
    if (scenes.size() > 1) {
        for (std::size_t i = 0; i < scenes[0].variants.size(); ++i) {
            std::vector<std::string> row = {
                "geometric mean", scenes[0].variants[i].variant.name, "", "", "", "", "", ""};
            for (const double target : kTargets) row.push_back(geometric_mean_seconds(scenes, i, target));
            table.add(std::move(row));
        }
    }
    return table.text();
}

std::string comparison_table(const std::vector<SceneConvergence>& scenes) {
    TextTable table(3, {"scene", "variant", "against", "time of a sample", "error", "efficiency [95%]"});
    bool any = false;
    for (const SceneConvergence& scene : scenes) {
        for (const VariantRuns& variant : scene.variants) {
            const VariantRuns& base = scene.variants[variant.variant.base];
            if (&base == &variant) continue;
            any = true;
            const Summary a(scene, variant), b(scene, base);
            const double error = mean_error(variant, a.last(), &ImageError::rel_mse).value;
            const double base_error = mean_error(base, b.last(), &ImageError::rel_mse).value;
            table.add({scene.name, variant.variant.name, base.variant.name,
                       fmt::format("x{:.3f}", b.samples_per_second() / a.samples_per_second()),
                       fmt::format("x{:.3f}", error / base_error), "x" + text(gain(scene, variant, base))});
        }
    }
    return any ? table.text() : "";
}

nlohmann::ordered_json convergence_json(const std::vector<SceneConvergence>& scenes) {
    nlohmann::ordered_json result = nlohmann::ordered_json::array();
    for (const SceneConvergence& scene : scenes) {
        nlohmann::ordered_json variants;
        for (const VariantRuns& variant : scene.variants) variants[variant.variant.name] = variant_json(scene, variant);
        result.push_back({{"scene", scene.name},
                          {"width", scene.width},
                          {"height", scene.height},
                          {"load_cpu_seconds", scene.load_cpu_seconds},
                          {"load_wall_seconds", scene.load_wall_seconds},
                          {"reference_uncertainty", scene.reference_uncertainty},
                          {"variants", std::move(variants)}});
    }
    return result;
}

}  // namespace rayuela
